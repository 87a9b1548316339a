"""A recorded episode for those who have neither the store nor the program: a video, or one page."""
