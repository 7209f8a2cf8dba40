//! Claims about the readers and writers of every format but OpenVDB's own.

mod corpus_nvdb;
mod corruptions;
mod dense;
mod facts;
mod nvdb_files;
mod round_trips;
