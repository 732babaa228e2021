"""The paper's method: straight pieces, sectors, angles by look-up."""
