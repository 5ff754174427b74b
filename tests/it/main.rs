//! What crosses modules, in one binary.

mod command;
mod docs;
mod layers;
mod licences;
mod output;
mod source;
