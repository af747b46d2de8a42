//! A log of what viewers are shown, and nothing else.

use std::{collections::BTreeMap, fs};

use flightcam::{
    derived::visual::{Shown, Visual},
    log::Log,
    messages::{Encoding, Format},
    writer::{Appender, LogWriter},
};

use super::shown;

/// Its messages, a second after each other.
pub fn messages() -> Vec<Shown> {
    let shown = |(visual, second): (Visual, u64)| Shown {
        time: second * 1_000_000_000 + 5,
        visual,
    };
    shown::visuals().into_iter().zip(1..).map(shown).collect()
}

/// The log with these messages.
pub fn write(format: &Format) -> Vec<u8> {
    let profile = match format.encoding {
        Encoding::Ros2 => "ros2",
        _ => "",
    };
    let empty = {
        let options = mcap::WriteOptions::new().profile(profile);
        let mut writer = options
            .create(std::io::Cursor::new(Vec::new()))
            .expect("a writer");
        writer.finish().expect("finished");
        writer.into_inner().into_inner()
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("empty.mcap");
    fs::write(&path, &empty).expect("written");
    let log = Log::open(&path).expect("a readable log");
    let mut result = empty[..log.data_end as usize].to_vec();
    let appender = Appender::begin(&log, &mut result, path.clone(), format.clone());
    let mut appender = Box::new(appender.expect("a writer"));
    for shown in messages() {
        appender.write((&shown).into()).expect("written");
    }
    appender.finish(BTreeMap::new()).expect("a result");
    result
}
