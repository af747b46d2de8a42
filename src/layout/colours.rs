//! Colours that can be told apart on white and on black.

pub const RED: &str = "#e5484d";
pub const GREEN: &str = "#30a46c";
pub const BLUE: &str = "#0091ff";
pub const ORANGE: &str = "#f76b15";
pub const PURPLE: &str = "#8e4ec6";
pub const GREY: &str = "#8a8a8a";

/// Almost white.
pub const LIGHT: &str = "#f4f6f8";

/// Those of the track in 3D.
pub const SLOW: &str = "#3373ff";
pub const FAST: &str = "#f79914";
