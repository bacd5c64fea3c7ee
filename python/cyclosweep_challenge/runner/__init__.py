"""A whole challenge: recordings, sealed answers, diagnoses, opponents and score; resumable."""
