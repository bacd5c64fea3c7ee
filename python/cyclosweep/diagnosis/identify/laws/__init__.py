"""Whether the law of a fitted effect holds, and which class of behaviour it stands for."""
