//! The options that say where a log has its telemetry; `enrich`, `inspect` and `check` share them.

use clap::{Args, ValueEnum, error::ErrorKind};
use flightcam::{
    Error,
    sample::{Kind, VelocityFrom},
    source::{
        profile::{ProfileChoice, SampleTime},
        request::{BadArgument, Request, RoleArgument, namespace},
    },
};

use super::{own_profiles, wrong_arguments};

/// Printed below the help of commands that take paths.
pub const EXAMPLES: &str = "\
Telemetry that no profile knows:
  --attitude, --velocity, --gimbal and --position take message paths as in
  Foxglove, /topic.field.sub[2], joined by commas, and then, after colons, the
  unit and the axes. For a log with names of its own:

    flightcam enrich flight.mcap --depression 30 \\
      --attitude /imu.roll,/imu.pitch,/imu.yaw:degrees \\
      --velocity /gps.vel.n,/gps.vel.e,/gps.vel.d:ned:cm/s

  --attitude /imu.roll,/imu.pitch,/imu.yaw:degrees
      three angles, in radians, degrees or centidegrees; if they turn in another
      order than yaw, pitch, roll, it follows, as in :yaw-roll-pitch
  --attitude /pose.orientation:flu-enu
      a message with w, x, y, z, in the axes of ROS
  --attitude /att.q:xyzw:frd-ned
      a list of four numbers, the scalar part last (wxyz, first, by default)
  --velocity /gps.vel.n,/gps.vel.e,/gps.vel.d:ned:cm/s
      three numbers; axes ned, enu, body-frd, body-flu, or any other three
      letters, such as neu; m/s, cm/s or mm/s
  --velocity /twist.linear:body-flu
      a message with x, y, z, or a list of three numbers
  --gimbal /gimbal.pitch:degrees
      the camera's pitch alone, positive up (with :down, positive down)
  --gimbal /gimbal.q:earth
      the camera's full orientation in any of the forms of an attitude, and
      what it is measured from: earth (north and the horizon), heading (the
      drone's nose and the horizon) or airframe (joint angles)
  --gimbal '/gimbal{device_id==1}.q:earth'
      the same, of several sources on the topic the one whose messages say so
  --attitude '/tf.transforms[:]{child_frame_id==\"base_link\"}.transform.rotation:flu-enu'
      the first element of a list that satisfies the filter
  --attitude '\"/fc.state\".q:frd-ned'
      a topic, or a name, with a dot in it
  --position /gps.lat,/gps.lon,/gps.alt:degE7:mm
      latitude, longitude, altitude, or x, y, z with :ned or :enu

  Orientations turn from front, right, down to north, east, down (frd-ned), or
  from front, left, up to east, north, up (flu-enu, as in ROS). A quaternion
  needs that, unless the type of its messages tells; angles are frd-ned.
  A topic alone, as in --attitude /odom, leaves the fields to the profile.
  A topic or a name with a dot needs double quotes: '\"/fc.state\".roll'. Brackets
  and double quotes mean something to the shell: put single quotes around them.";

/// Where the telemetry is
#[derive(Debug, Args)]
#[command(next_help_heading = "Telemetry")]
pub struct TelemetryArguments {
    /// How the log names its telemetry: a profile by its name (`flightcam profiles` lists them), or a TOML file of
    /// your own [default: the best fit]
    #[arg(long, value_name = "NAME|FILE")]
    profile: Option<String>,

    /// Which vehicle, if the log has several: the prefix of its topics, as in /drone1; / means no prefix
    #[arg(long, value_name = "PREFIX", value_parser = namespace)]
    namespace: Option<String>,

    /// Where the drone's attitude is, if not where the profile says, as in /pose.orientation:flu-enu
    #[arg(long, value_name = "PATHS[:CONVENTION]", value_parser = role(Kind::Attitude))]
    attitude: Option<RoleArgument>,

    /// Where the drone's velocity over ground is, as in /gps.vel:ned
    #[arg(long, value_name = "PATHS:AXES[:UNIT]", value_parser = role(Kind::Velocity))]
    velocity: Option<RoleArgument>,

    /// Where the angles of a moving gimbal are, as in /gimbal.pitch:degrees; the camera follows them
    #[arg(long, value_name = "PATHS:UNIT|REFERENCE", value_parser = role(Kind::Gimbal))]
    gimbal: Option<RoleArgument>,

    /// Where the drone's position is, as in /gps.lat,/gps.lon,/gps.alt:degrees
    #[arg(long, value_name = "PATHS:UNIT|AXES", value_parser = role(Kind::Position))]
    position: Option<RoleArgument>,

    /// What the velocity is taken from
    #[arg(long, value_enum, value_name = "SOURCE", default_value = "messages")]
    velocity_from: VelocityFromArgument,

    /// What the time of a sample is: when it was logged, when it was published, or what a field of the message
    /// says in s, ms, us or ns, as in header.stamp or time_usec:us [default: what the profile says, usually log]
    #[arg(long, value_name = "log|publish|FIELD[:UNIT]")]
    time: Option<SampleTime>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum VelocityFromArgument {
    /// Messages that have it
    Messages,
    /// The change of the drone's position from one message to the next, for a log without a usable velocity
    Position,
}

impl From<VelocityFromArgument> for VelocityFrom {
    fn from(argument: VelocityFromArgument) -> Self {
        match argument {
            VelocityFromArgument::Messages => Self::Messages,
            VelocityFromArgument::Position => Self::Position,
        }
    }
}

/// Parses the argument of a role.
pub fn role(kind: Kind) -> impl Fn(&str) -> Result<RoleArgument, BadArgument> + Clone {
    move |text| RoleArgument::parse(kind, text)
}

impl TelemetryArguments {
    /// Converts the arguments to the library's request.
    pub fn request(&self) -> Result<Request, Error> {
        let roles = [
            (Kind::Attitude, &self.attitude),
            (Kind::Velocity, &self.velocity),
            (Kind::Gimbal, &self.gimbal),
            (Kind::Position, &self.position),
        ];
        if self.velocity.is_some() && matches!(self.velocity_from, VelocityFromArgument::Position) {
            wrong_arguments(
                ErrorKind::ArgumentConflict,
                "--velocity says where the velocity is, and --velocity-from position that it is not read; leave out \
                 one of the two",
            );
        }
        let given = roles
            .into_iter()
            .filter_map(|(kind, argument)| Some((kind, argument.clone()?)));
        Ok(Request {
            profile: match &self.profile {
                Some(name_or_file) => {
                    ProfileChoice::Given(Box::new(own_profiles::load(name_or_file)?))
                }
                None => ProfileChoice::Automatic,
            },
            own_profiles: match self.profile {
                Some(_) => Vec::new(),
                None => {
                    let own = own_profiles::all()?.into_iter();
                    own.map(|own| own.profile).collect()
                }
            },
            namespace: self.namespace.clone(),
            roles: given.collect(),
            time: self.time.clone(),
            velocity_from: self.velocity_from.into(),
        })
    }
}
