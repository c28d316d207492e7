"""What the functions of the library return: each as a dictionary, as text and as a figure."""
