"""Three points explained step by step: numbers, words and a picture."""
