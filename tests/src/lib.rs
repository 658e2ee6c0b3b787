//! The test suite: agreement, statistics, snapshots, properties, tidy.
