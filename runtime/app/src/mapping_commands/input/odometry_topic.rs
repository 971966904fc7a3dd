//! Which odometry of a bag is used.

use std::collections::BTreeMap;

use floorguard_mapping_host::input::OdometryTrack;
use floorguard_recording::truth::is_truth;

/// The topic whose name says so, or the first; never the truth of a simulator. `None` where it is empty.
pub fn chosen_odometry(mut topics: BTreeMap<String, OdometryTrack>) -> Option<OdometryTrack> {
    topics.retain(|topic, _| !is_truth(topic));
    let named = topics.keys().find(|topic| topic.contains("odom")).cloned();
    let topic = named.or_else(|| topics.keys().next().cloned())?;
    topics.remove(&topic).filter(|track| !track.is_empty())
}

#[cfg(test)]
mod tests {
    use floorguard_mapping_host::Se2;
    use floorguard_recording::truth::TRUE_ODOMETRY;

    use super::*;

    #[test]
    fn truth_of_a_simulator_is_no_odometry() {
        let track = |x_m: f64| {
            let mut track = OdometryTrack::default();
            track.push(1.0, Se2::new(x_m, 0.0, 0.0));
            track
        };
        let chosen = |names: &[&str]| {
            let topics =
                names.iter().zip(1..).map(|(name, number)| (String::from(*name), track(number.into())));
            chosen_odometry(topics.collect()).map(|track| track.at(1.0).unwrap().x_m)
        };
        assert_eq!(chosen(&[TRUE_ODOMETRY, "/odometry"]), Some(2.0));
        assert_eq!(chosen(&[TRUE_ODOMETRY]), None);
        assert_eq!(chosen(&["/base/pose", "/wheel/odom"]), Some(2.0));
    }
}
