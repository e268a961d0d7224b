"""Making places: the water of charts, outlines and images on a grid."""
