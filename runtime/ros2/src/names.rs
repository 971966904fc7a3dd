//! How ROS 2 writes its names into DDS.
//!
//! Source: ROS 2 design, "Topic and Service name mapping to DDS"; the names of the types as `rosidl` gives them to DDS.

/// A topic's name in DDS.
pub fn topic(name: &str) -> String {
    format!("rt{}", absolute(name))
}

/// Where requests of a service come.
pub fn request_topic(service: &str) -> String {
    format!("rq{}Request", absolute(service))
}

/// Where its answers go.
pub fn reply_topic(service: &str) -> String {
    format!("rr{}Reply", absolute(service))
}

/// A type's name in DDS: `tf2_msgs/msg/TFMessage` is `tf2_msgs::msg::dds_::TFMessage_`.
pub fn dds_type(name: &str) -> String {
    match name.rsplit_once('/') {
        Some((folder, last)) => format!("{}::dds_::{last}_", folder.replace('/', "::")),
        None => name.to_owned(),
    }
}

/// A name of the root.
fn absolute(name: &str) -> String {
    format!("/{}", name.trim_start_matches('/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_design() {
        assert_eq!(topic("/tf"), "rt/tf");
        assert_eq!(topic("people/costmap"), "rt/people/costmap");
        assert_eq!(dds_type("tf2_msgs/msg/TFMessage"), "tf2_msgs::msg::dds_::TFMessage_");
        assert_eq!(dds_type("std_srvs/srv/Trigger_Request"), "std_srvs::srv::dds_::Trigger_Request_");
        assert_eq!(request_topic("/floorguard/pause"), "rq/floorguard/pauseRequest");
        assert_eq!(reply_topic("/floorguard/pause"), "rr/floorguard/pauseReply");
    }
}
