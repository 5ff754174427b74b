//! Programs: blocks, dialects, the reader.
