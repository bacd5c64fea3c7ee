"""What others would write for the same table: one small file each."""
