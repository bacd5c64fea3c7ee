"""A whole challenge: recordings, committed answers, diagnoses, opponents and score; resumable."""
