//! One pure function per job: values in, values out.
