//! Hints for a log whose telemetry is not found or is ambiguous.

use flightcam::source::error::{Misfit, TelemetryError};

/// What the user can do about an error.
pub fn hint(error: &TelemetryError) -> Option<String> {
    Some(match error {
        TelemetryError::NotFound { tried, .. } => {
            let fields = tried.iter().find_map(|(_, misfit)| give_fields(misfit));
            fields.unwrap_or_else(|| {
                "say where it is with --attitude and --velocity (explained by `flightcam enrich --help`), \
                 or in a profile of your own (--profile FILE.toml, explained in docs/profiles.md)"
                    .to_owned()
            })
        }
        TelemetryError::SeveralTopicsFit { topics, .. } => {
            choose_one("--attitude", topics.first()?)
        }
        TelemetryError::SeveralProfilesFit { fits, .. } => {
            let (profile, _) = fits.first()?;
            choose_one("--profile", profile)
        }
        TelemetryError::SeveralVehicles { namespaces, .. } => {
            let namespace = match namespaces.first()?.as_str() {
                "" => "/",
                namespace => namespace,
            };
            choose_one("--namespace", namespace)
        }
        TelemetryError::NoSuchNamespace { .. } => "correct --namespace, or leave it out".to_owned(),
        TelemetryError::RoleDoesNotFit { role, .. } => {
            format!("correct --{}, or leave it out", role.name())
        }
        TelemetryError::ProfileDoesNotFit { misfit, .. } => give_fields(misfit)?,
        _ => return None,
    })
}

fn choose_one(option: &str, value: &str) -> String {
    format!("choose one, for instance with {option} {value}")
}

fn give_fields(misfit: &Misfit) -> Option<String> {
    match misfit {
        Misfit::OnlyATopic { role } => {
            let role = role.name();
            Some(format!("give --{role} fields, not only a topic"))
        }
        _ => None,
    }
}
