//! What is written for each moment of a flight is encoded without needless allocations.

use allocation_counter::measure;
use flightcam::{
    derived::visual::{State, Visual},
    messages::{Encoding, Message},
};

use super::{format, shown};
use crate::support::shown as content;

#[test]
fn encoding_allocates_the_names_and_lists_of_prosts_types_and_nothing_in_ros_2() {
    let transforms = content::transforms();
    // A list, and the names of two frames in each.
    let in_transforms = 1 + 2 * transforms.len() as u64;
    for (visual, in_protobuf) in [
        (Visual::Transforms(transforms), in_transforms),
        (Visual::Odometry(content::odometry()), 2),
        (Visual::Pose(content::pose()), 1),
        (Visual::Location(content::location()), 1),
        (Visual::State(State { name: "ok" }), 1),
        (Visual::Display(content::display()), 0),
    ] {
        let shown = shown(visual);
        for (encoding, expected) in [(Encoding::Protobuf, in_protobuf), (Encoding::Ros2, 0)] {
            let format = format(encoding);
            let mut out = Vec::with_capacity(4096);
            let found = measure(|| format.encode(&Message::from(&shown), &mut out));
            assert_eq!(found.count_total, expected, "{shown:?}");
        }
    }
}
