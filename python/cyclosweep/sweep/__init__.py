"""From a space of variants to a table: space, study, lazy scan, Parquet dataset, workers."""
