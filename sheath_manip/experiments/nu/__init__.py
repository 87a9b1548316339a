"""How the size of the support changes learning, by the nu of its one-class SVM."""
