//! Frames: what types of message say about theirs, and which axes their names stand for.
//!
//! | file | subject |
//! | --- | --- |
//! | [`rules`] | what each type of message says: which fields name its frames, what marks a value as not valid |
//! | [`names`] | a frame's name → the axes that it stands for |
//! | [`resolve`] | what was said and what the names stand for → the axes in which a value is read |
//! | [`taken`] | the axes that were taken and why, for the report |

pub mod names;
pub mod resolve;
pub mod rules;
pub mod taken;
