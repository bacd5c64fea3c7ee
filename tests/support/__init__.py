"""Material shared by the tests."""
