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
mod last;
mod layers;
mod licences;
mod linuxcnc;
mod machine_files;
mod machines;
mod oracles;
mod output;
mod page;
mod parts;
mod programs;
mod random_cases;
mod rs274;
mod shapes;
mod small_machines;
mod source;
mod textbook;
