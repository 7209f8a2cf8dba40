//! Claims about the readers and writers of every format but OpenVDB.

mod corpus_nvdb;
mod facts;
