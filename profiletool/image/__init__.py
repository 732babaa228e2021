"""Picture files to a silhouette in pixels; the only room that imports cv2."""
