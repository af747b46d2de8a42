//! How the camera is mounted, in words.

use flightcam::report::{CameraReport, ProfileReport};

pub fn camera(camera: &CameraReport, profile: &ProfileReport) -> String {
    let camera = mounting(camera);
    match profile.gives_camera {
        true => format!("{camera}, as the profile says"),
        false => camera,
    }
}

fn mounting(camera: &CameraReport) -> String {
    match *camera {
        CameraReport::Stabilised {
            depression_deg,
            yaw_offset_deg,
        } => stabilised(depression_deg, yaw_offset_deg),
        CameraReport::Fixed {
            mount_deg: [roll, pitch, yaw],
        } => format!("bolted to the airframe at roll {roll}°, pitch {pitch}°, yaw {yaw}°"),
        CameraReport::Gimbal => "follows the gimbal".to_owned(),
        ref other => format!("{other:?}"),
    }
}

fn stabilised(depression: f64, yaw_offset: f64) -> String {
    let looks = match depression {
        0.0 => "looks at the horizon".to_owned(),
        up if up < 0.0 => format!("looks {}° above the horizon", -up),
        down => format!("looks {down}° below the horizon"),
    };
    match yaw_offset {
        0.0 => looks,
        left if left < 0.0 => format!("{looks}, {}° to the left of the nose", -left),
        right => format!("{looks}, {right}° to the right of the nose"),
    }
}
