//! The options that say where a log has its telemetry; `enrich` and `inspect` share them.

use clap::Args;
use flightcam::{
    Error,
    source::{
        profile::{
            AttitudeSource, GimbalSource, PositionSource, Profile, ProfileChoice, TimeSource,
            VelocitySource,
        },
        request::{Request, RoleArgument, namespace},
    },
};

/// What is printed below the help, where a path is wanted.
pub const EXAMPLES: &str = "\
Telemetry that no profile knows:
  Each of --attitude, --velocity, --gimbal and --position takes message paths as in Foxglove,
  /topic.field.sub[2], joined by commas, and behind colons the unit and the convention:

  --attitude /imu.roll,/imu.pitch,/imu.yaw:degrees   roll, pitch, yaw (radians, degrees, centidegrees)
  --attitude /pose.orientation:flu-enu               a message with w, x, y, z; ROS axes
  --attitude /att.q:xyzw                             a list of four, the scalar part last
  --velocity /gps.vel.n,/gps.vel.e,/gps.vel.d:ned:cm/s
  --velocity /twist.linear:body-flu                  a message with x, y, z, or a list of three
  --gimbal   /gimbal.pitch:degrees                   the camera's pitch over the horizon (`:down` below it)
  --gimbal   /gimbal.q:earth                         its whole attitude, measured from NED
                                                     (heading: from the nose; airframe: joint angles)
  --position /gps.lat,/gps.lon,/gps.alt:degE7:mm     or x, y, z with :ned or :enu

  A topic alone, --attitude /odom, leaves the fields to the profile.
  Axes: frd-ned (front, right, down in north, east, down; the default) or flu-enu (ROS); for a velocity
  ned, enu, body-frd or body-flu. In a shell, put quotes around paths with brackets.";

/// Where the telemetry is
#[derive(Debug, Args)]
#[command(next_help_heading = "Telemetry")]
pub struct TelemetryArguments {
    /// How the log names its telemetry: a built-in profile (`flightcam profiles` lists them), or a TOML file of
    /// one's own [default: what fits best]
    #[arg(long, value_name = "NAME|FILE")]
    profile: Option<String>,

    /// Which vehicle, where a log has several: the prefix of its topics, as /drone1; / is the one without
    #[arg(long, value_name = "PREFIX", value_parser = namespace)]
    namespace: Option<String>,

    /// Where the drone's attitude is, if not where the profile says
    #[arg(long, value_name = "PATHS[:CONVENTION]")]
    attitude: Option<RoleArgument<AttitudeSource>>,

    /// Where its velocity over ground is
    #[arg(long, value_name = "PATHS:AXES[:UNIT]")]
    velocity: Option<RoleArgument<VelocitySource>>,

    /// Where the angles of a gimbal that moves are
    #[arg(long, value_name = "PATHS:UNIT|REFERENCE")]
    gimbal: Option<RoleArgument<GimbalSource>>,

    /// Where the drone's position is
    #[arg(long, value_name = "PATHS:UNIT|AXES")]
    position: Option<RoleArgument<PositionSource>>,

    /// What the time of a sample is: log, publish, or a field of the message with its unit (s, ms, us, ns), as
    /// header.stamp or time_usec:us [default: the profile's, mostly log]
    #[arg(long, value_name = "log|publish|FIELD[:UNIT]")]
    time: Option<TimeSource>,
}

impl TelemetryArguments {
    /// As the library takes it.
    pub fn request(&self) -> Result<Request, Error> {
        Ok(Request {
            profile: match &self.profile {
                Some(name_or_file) => ProfileChoice::Given(Box::new(Profile::load(name_or_file)?)),
                None => ProfileChoice::Automatic,
            },
            namespace: self.namespace.clone(),
            attitude: self.attitude.clone(),
            velocity: self.velocity.clone(),
            gimbal: self.gimbal.clone(),
            position: self.position.clone(),
            time: self.time.clone(),
        })
    }
}
