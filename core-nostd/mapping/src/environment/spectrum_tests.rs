//! The test values of the book, Environment: Spectrum, and NumPy's Fourier transform as an independent judge.

use super::*;

/// A Monday, 00:00.
const MONDAY_S: i64 = 4 * 86_400;

fn at(seconds: i64) -> LocalTime {
    LocalTime::from_seconds(MONDAY_S + seconds)
}

/// s = 1 from 08:00 to 17:59, every hour for seven days.
fn office_hours() -> Spectrum<24> {
    let mut spectrum = Spectrum::daily();
    for hour in 0..168 {
        spectrum.add(at(hour * 3_600), f32::from(u8::from((8..18).contains(&(hour % 24)))), 1.0);
    }
    spectrum
}

#[test]
fn the_vector_of_the_specification() {
    let spectrum = office_hours();
    assert!((spectrum.mean() - 0.416_667).abs() < 1e-6);
    let strongest = spectrum.tones()[0];
    assert_eq!(strongest.harmonic, 1);
    assert!((strongest.amplitude - 0.308_344).abs() < 1e-6, "{strongest:?}");
    assert!((strongest.phase_rad - 3.010_693).abs() < 1e-5, "{strongest:?}");
    assert!((spectrum.predict(at(13 * 3_600), 1) - 1.028_078).abs() < 1e-5);
    assert!((spectrum.predict(at(3_600), 1) + 0.194_745).abs() < 1e-5);
    assert_eq!(spectrum.predict_probability(at(13 * 3_600), 1), 0.98);
    assert_eq!(spectrum.predict_probability(at(3_600), 1), 0.02);
}

/// Three weeks, a sample every ten minutes: working hours from Monday to Friday, and noise that both sides can make.
fn three_weeks() -> Spectrum<84> {
    let mut spectrum = Spectrum::weekly();
    for i in 0..3 * 1_008_i64 {
        let (hour, weekday) = (i / 6 % 24, i / 144 % 7);
        let noise = ((i * i * 7_919 + i * 104_729) % 1_000) as f32 / 1_000.0;
        let works = (9..17).contains(&hour) && weekday < 5;
        spectrum.add(at(i * 600), 0.2 * noise + if works { 0.6 } else { 0.0 }, 1.0);
    }
    spectrum
}

/// NumPy 2.4: `F = np.fft.fft(s)/n`, harmonics k of the week are `F[3*k]`.
#[test]
fn agrees_with_numpy_on_whole_weeks() {
    let spectrum = three_weeks();
    assert!((spectrum.mean() - 0.243_052_91).abs() < 1e-6);
    let expected = [
        (7, 0.117_382_616, 2.897_699_6),
        (14, 0.058_692_682, -0.496_832_3),
        (1, 0.052_282_304, -2.298_119_9),
        (6, 0.045_125_66, -1.075_360_4),
    ];
    for (tone, (harmonic, amplitude, phase_rad)) in spectrum.tones().iter().zip(expected) {
        assert_eq!(tone.harmonic, harmonic);
        assert!((tone.amplitude - amplitude).abs() < 2e-6, "{tone:?}");
        assert!((tone.phase_rad - phase_rad).abs() < 2e-5, "{tone:?}");
    }
    let predictions = [
        (60_000, [0.243_052_91, 0.374_243_78, 0.331_157_85, 0.320_303_6, 0.240_124_88]),
        (420_300, [0.243_052_91, 0.135_465_5, 0.066_523_82, 0.016_620_28, 0.106_867_57]),
        (570_000, [0.243_052_91, 0.462_187, 0.550_055_8, 0.457_403_4, 0.367_630_03]),
    ];
    for (seconds, values) in predictions {
        for (order, value) in values.iter().enumerate() {
            let ours = spectrum.predict(at(seconds), order);
            assert!((ours - value).abs() < 5e-6, "{seconds} s, order {order}: {ours} for {value}");
        }
    }
}

#[test]
fn unrepeated_periods_are_not_used() {
    let mut spectrum = Spectrum::<84>::weekly();
    for i in 0..40_i64 {
        spectrum.add(at(i * 600), f32::from(u8::from(i % 18 < 9)), 1.0);
    }
    // 6.5 hours watched: no period longer than that.
    assert!(
        spectrum
            .tones()
            .iter()
            .all(|tone| tone.harmonic == 0 || 604_800 / u32::from(tone.harmonic) <= 23_400)
    );
    assert_eq!(Spectrum::<84>::weekly().tones(), [Tone::default(); ORDER_MAX]);
}

#[test]
fn uneven_sampling_of_a_constant_shows_no_period() {
    let mut spectrum = Spectrum::<24>::daily();
    for hour in (0..24 * 14).filter(|hour| hour % 24 < 9) {
        spectrum.add(at(hour * 3_600), 0.7, 0.25);
    }
    assert!(spectrum.tones()[0].amplitude < 1e-5);
    assert!((spectrum.predict(at(20 * 3_600), 4) - 0.7).abs() < 1e-4);
}

#[test]
fn weights_count_as_repetitions_fading_keeps_shape() {
    let mut heavy = Spectrum::<24>::daily();
    let mut often = Spectrum::<24>::daily();
    for hour in 0..72_i64 {
        let value = (hour % 5) as f32;
        heavy.add(at(hour * 3_600), value, 3.0);
        (0..3).for_each(|_| often.add(at(hour * 3_600), value, 1.0));
    }
    assert!((heavy.predict(at(777), 4) - often.predict(at(777), 4)).abs() < 1e-5);
    let before = heavy.predict(at(5_000), 3);
    heavy.scale(0.25);
    assert!((heavy.predict(at(5_000), 3) - before).abs() < 1e-5);
    assert_eq!(heavy.weight(), 54.0);
}

#[test]
fn hostile_samples_change_nothing() {
    let mut spectrum = office_hours();
    let before = spectrum;
    for (value, weight) in
        [(f32::NAN, 1.0), (f32::INFINITY, 1.0), (1.0, f32::NAN), (1.0, 0.0), (1.0, -1.0), (0.0, 1e30)]
    {
        spectrum.add(at(0), value, weight);
    }
    assert_eq!(spectrum, before);
    for extreme in [i64::MIN, i64::MAX] {
        let mut spectrum = office_hours();
        spectrum.add(LocalTime::from_seconds(extreme), 1.0, 1.0);
        let probability = spectrum.predict_probability(at(0), 9);
        assert!((0.02..=0.98).contains(&probability));
    }
}
