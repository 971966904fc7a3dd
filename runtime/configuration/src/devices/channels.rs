//! What two inputs cannot share, a bit of the safety controller's image, and channels that cannot be safe.

use floorguard_drivers::flexisoft::InputBits;

use crate::reader::Reader;

/// The key has a number for each of two channels.
fn is_pair(section: &Reader<'_>, key: &'static str) -> bool {
    let value = section.find(key).and_then(|value| value.get_ref().as_array());
    value.is_some_and(|numbers| numbers.len() > 1)
}

/// Refuses two channels of an input on one bit, and two inputs on one bit. Each input comes with its key.
pub(super) fn check_bits(section: &Reader<'_>, inputs: &[(&'static str, Option<InputBits>)]) {
    let fitted = || inputs.iter().filter_map(|(key, input)| input.map(|input| (*key, input.bits)));
    let place = |key: &'static str| section.find(key).map_or(0..0, |value| value.span());
    for (index, (key, [first, second])) in fitted().enumerate() {
        if first == second && is_pair(section, key) {
            let what = format!("[inputs]: both channels of `{key}` are bit {first}");
            section.refuse_to_drive(
                &place(key),
                what,
                "give each channel its own bit, or write a single one for an input with one channel",
            );
        }
        let shared = |bits: [u8; 2]| [first, second].into_iter().find(|bit| bits.contains(bit));
        let other = fitted().take(index).find_map(|(other, bits)| shared(bits).map(|bit| (other, bit)));
        if let Some((other, bit)) = other {
            let what = format!("[inputs]: bit {bit} of `{key}` is one of `{other}`, too");
            section.refuse_to_drive(&place(key), what, "give each input its own bits");
        }
    }
}

/// Refuses an emergency stop with one channel, and inputs on whose every channel a cut wire means that all is well: the safety manual,
/// section 2, asks for two channels with 1 as the operating state.
pub(super) fn check_channels(section: &Reader<'_>, inputs: &[(&'static str, Option<InputBits>)]) {
    for (key, input) in inputs {
        let Some(InputBits { bits: [first, second], inverted }) = input else { continue };
        let place = section.find(key).map_or(section.span().clone(), |value| value.span());
        if *key == "emergency_stop_bits" && first == second && !is_pair(section, key) && section.good_so_far()
        {
            section.refuse_to_drive(
                &place,
                format!("[inputs]: `{key}` has one channel, bit {first}: a single fault and the button is not heard"),
                "wire both channels of the emergency stop to the safety controller, and write both bits, for example [32, 33]",
            );
        }
        if inverted.iter().all(|inverted| *inverted) && section.good_so_far() {
            section.refuse_to_drive(
                &place,
                format!("[inputs]: every channel of `{key}` is in `inverted_bits`: a cut wire reads as all is well"),
                "let at least one channel be 1 in the operating state, and leave its bit out of `inverted_bits`",
            );
        }
    }
}
