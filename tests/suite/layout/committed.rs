//! The layouts that the repository has are those that the program writes for the demonstration flight.

use crate::support::{folder::*, repository};

#[test]
fn the_layouts_in_the_repository_are_those_of_the_demonstration_flight() {
    let folder = Folder::with_flight();
    let arguments = "--depression 30 --visuals --hfov 70 --vfov 50";
    folder.run(&format!("enrich {LOG} {arguments}"), 0);
    for viewer in ["lichtblick", "foxglove"] {
        let (layout, err) = folder.run(&format!("layout {RESULT} --for {viewer}"), 0);
        assert_eq!(err, "");
        let file = repository(&format!("foxglove/layout.{viewer}.json"));
        let committed = std::fs::read_to_string(file).expect("the layout in the repository");
        // A checkout on Windows may have other ends of lines.
        assert_eq!(committed.replace('\r', ""), layout, "{viewer}");
    }
}
