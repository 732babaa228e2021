"""The inflated tube in a picture: found, and its joints' angles measured."""
