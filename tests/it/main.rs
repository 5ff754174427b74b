//! What crosses modules, in one binary.

mod bad_files;
mod command;
mod digitize;
mod digitize_cases;
mod digitize_foot;
mod digitize_soups;
mod docs;
mod dropping;
mod formats;
mod layers;
mod licences;
mod machine_files;
mod machines;
mod oracles;
mod output;
mod parts;
mod random_cases;
mod shapes;
mod source;
mod textbook;
