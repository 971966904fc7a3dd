//! The services of `std_srvs`: pause, resume, reset. Their answer says what was handed over; what the guard makes of it stands in
//! `/diagnostics`.
//!
//! Sources: std_srvs 5.3 (`Trigger`); OMG DDS-RPC 1.0, basic service mapping, for how `rmw_fastrtps` names a request; the source of
//! `rmw_cyclonedds_cpp`, which writes the name of a request before its content.

use floorguard_recording::cdr::Encoder;
use rustdds::{SampleIdentity, WriteOptionsBuilder};

use super::dds::{MessageReader, MessageWriter, Named, Participant, Quality, Refused, Sample};
use super::names;
use super::requests::RosRequest;

/// What can be asked for.
const OFFERED: [(&str, RosRequest); 3] = [
    ("/floorguard/pause", RosRequest::Pause),
    ("/floorguard/resume", RosRequest::Resume),
    ("/floorguard/reset", RosRequest::Reset),
];
/// Bytes of a request's name where it is written before the content: two numbers.
const NAME_BYTES: usize = 16;
/// Bytes before a message that say how it is written.
const HEADER_BYTES: usize = 4;

/// One service.
pub struct Service {
    requests: MessageReader,
    answers: MessageWriter,
    request: RosRequest,
}

/// All services, over a participant.
///
/// # Errors
/// DDS refuses one.
pub fn open(participant: &mut Participant) -> Result<Vec<Service>, Refused> {
    let open = |(name, request): &(&str, RosRequest)| {
        let asked = Named { topic: names::request_topic(name), kind: "std_srvs/srv/Trigger_Request" };
        let answered = Named { topic: names::reply_topic(name), kind: "std_srvs/srv/Trigger_Response" };
        Ok(Service {
            requests: participant.reader(&asked, true)?,
            answers: participant.writer(&answered, Quality::Newest(8))?,
            request: *request,
        })
    };
    OFFERED.iter().map(open).collect()
}

impl Service {
    /// Answers what has come; `hand_over` says whether the robot takes it.
    pub fn attend(&mut self, mut hand_over: impl FnMut(RosRequest) -> bool) {
        while let Ok(Some(sample)) = self.requests.take_next_sample() {
            let (taken, message) = match hand_over(self.request) {
                true => (true, "handed to the robot; /diagnostics shows what it makes of it"),
                false => (false, "the robot has too many requests; ask again"),
            };
            let options = WriteOptionsBuilder::new().related_sample_identity(identity(&sample)).build();
            let answer = response(before_content(sample.value()), taken, message);
            // A program that has gone gets no answer.
            let _ = self.answers.write_with_options(answer, options);
        }
    }
}

/// Whom the answer is for: the reader that the request names, or its writer.
fn identity(sample: &Sample) -> SampleIdentity {
    let own = sample.sample_info().sample_identity();
    let named = sample.sample_info().related_sample_identity().map(|related| related.writer_guid);
    let writer_guid = named.filter(|guid| guid.to_bytes() != [0; 16]).unwrap_or(own.writer_guid);
    SampleIdentity { writer_guid, ..own }
}

/// The request's name where it stands before the content, whose own length is one byte.
fn before_content(message: &[u8]) -> &[u8] {
    let content = message.get(HEADER_BYTES..).unwrap_or_default();
    content.get(..NAME_BYTES).unwrap_or_default()
}

/// `std_srvs/srv/Trigger_Response`.
fn response(name: &[u8], success: bool, message: &str) -> Vec<u8> {
    let mut encoder = Encoder::new();
    name.iter().for_each(|byte| _ = encoder.u8(*byte));
    encoder.u8(u8::from(success)).text(message);
    encoder.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn name_of_a_request_comes_back() {
        let name: Vec<u8> = (1..=16).collect();
        let asked = [&[0, 1, 0, 0][..], &name, &[0]].concat();
        assert_eq!(before_content(&asked), name);
        let answer = response(before_content(&asked), true, "a");
        assert_eq!(answer[4..], [&name[..], &[1, 0, 0, 0, 2, 0, 0, 0, b'a', 0]].concat());
        // Where the name is elsewhere, nothing stands before the content.
        assert_eq!(before_content(&[0, 1, 0, 0, 0]), [0_u8; 0]);
        assert_eq!(response(&[], false, "a")[4..], [0, 0, 0, 0, 2, 0, 0, 0, b'a', 0]);
    }
}
