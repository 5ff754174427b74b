//! Decimal numbers as programs write them: rounded once, never `-0`, no exponent.

/// `value` rounded to `decimals` places; ties go away from zero, zero has no sign.
pub(super) fn round_to(value: f64, decimals: u8) -> f64 {
    let scale = 10_f64.powi(i32::from(decimals));
    let scaled = (value * scale).round();
    if scaled == 0.0 { 0.0 } else { scaled / scale }
}

/// The greatest number of `digits` significant digits that is not above the positive `value`.
///
/// Feeds are rounded down so that rounding never makes a move faster than it was planned.
pub(super) fn floor_to_digits(value: f64, digits: u8) -> f64 {
    let decimals = decimals_for(value, digits);
    // A product like 2.3e5 falls an ulp short of the integer it stands for; an ulp is no rounding.
    let nudged = value * (1.0 + 4.0 * f64::EPSILON);
    if decimals >= 0 {
        let scale = 10_f64.powi(decimals);
        (nudged * scale).floor() / scale
    } else {
        let scale = 10_f64.powi(-decimals);
        (nudged / scale).floor() * scale
    }
}

/// The greatest number of `digits` significant digits and at most `decimals` places that is not
/// above the positive `value`; it can be 0.
pub(super) fn floor_to(value: f64, digits: u8, decimals: u8) -> f64 {
    if decimals_for(value, digits) <= i32::from(decimals) {
        return floor_to_digits(value, digits);
    }
    let scale = 10_f64.powi(i32::from(decimals));
    (value * (1.0 + 4.0 * f64::EPSILON) * scale).floor() / scale
}

/// The least number of `digits` significant digits and at most `decimals` places that is not below
/// the positive `value`.
pub(super) fn ceil_to(value: f64, digits: u8, decimals: u8) -> f64 {
    let places = decimals_for(value, digits).min(i32::from(decimals));
    let nudged = value * (1.0 - 4.0 * f64::EPSILON);
    if places >= 0 {
        let scale = 10_f64.powi(places);
        (nudged * scale).ceil() / scale
    } else {
        let scale = 10_f64.powi(-places);
        (nudged / scale).ceil() * scale
    }
}

/// Appends `value` with at most `decimals` places, trailing zeros cut but for one: `12.5`, `-3.0`.
pub(super) fn push_fixed(text: &mut Vec<u8>, value: f64, decimals: u8) {
    let scaled = (value * 10_f64.powi(i32::from(decimals))).round();
    if scaled.abs() >= 9e15 || decimals == 0 {
        // Beyond what an f64 counts exactly; the standard formatter still prints every digit.
        let value = if scaled == 0.0 { 0.0 } else { value };
        text.extend_from_slice(format!("{value:.*}", usize::from(decimals)).as_bytes());
        return;
    }
    if scaled < 0.0 {
        text.push(b'-');
    }
    push_scaled(text, scaled.abs() as u64, usize::from(decimals));
}

/// Appends the positive `value` with `digits` significant digits, but one place at least and
/// `decimals` at most.
pub(super) fn push_digits(text: &mut Vec<u8>, value: f64, digits: u8, decimals: u8) {
    let places = decimals_for(value, digits).clamp(1, i32::from(decimals).max(1));
    push_fixed(text, value, places as u8);
}

/// Places after the point that leave `digits` significant digits; negative left of the point.
fn decimals_for(value: f64, digits: u8) -> i32 {
    i32::from(digits) - 1 - value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32
}

/// Appends `scaled / 10^decimals`, `decimals` at least 1.
fn push_scaled(text: &mut Vec<u8>, mut scaled: u64, decimals: usize) {
    let mut digits = [b'0'; 24];
    let mut first = digits.len();
    while scaled > 0 || digits.len() - first <= decimals {
        first -= 1;
        digits[first] = b'0' + (scaled % 10) as u8;
        scaled /= 10;
    }
    let point = digits.len() - decimals;
    let mut end = digits.len();
    while end > point + 1 && digits[end - 1] == b'0' {
        end -= 1;
    }
    text.extend_from_slice(&digits[first..point]);
    text.push(b'.');
    text.extend_from_slice(&digits[point..end]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fixed(value: f64, decimals: u8) -> String {
        let mut text = Vec::new();
        push_fixed(&mut text, value, decimals);
        String::from_utf8(text).unwrap()
    }

    fn digits(value: f64, n_digits: u8) -> String {
        let mut text = Vec::new();
        push_digits(&mut text, value, n_digits, 9);
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn fixed_numbers_are_exact_decimals_without_negative_zero() {
        assert_eq!(fixed(12.5, 4), "12.5");
        assert_eq!(fixed(-3.0, 4), "-3.0");
        assert_eq!(fixed(-0.000_04, 4), "0.0");
        assert_eq!(fixed(-0.000_06, 4), "-0.0001");
        assert_eq!(fixed(0.1 + 0.2, 4), "0.3");
        assert_eq!(fixed(50_400.123_45, 3), "50400.123");
        assert_eq!(fixed(1e17, 3), "100000000000000000.000");
        assert_eq!(fixed(-0.2, 0), "0");
    }

    #[test]
    fn a_rounded_number_is_written_and_parsed_to_the_same_bits() {
        for i in -20_000..20_000 {
            let value = round_to(f64::from(i) * 0.123_457, 4);
            assert_eq!(fixed(value, 4).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }

    #[test]
    fn feeds_are_rounded_down_to_their_digits() {
        assert_eq!(floor_to_digits(21_599.99, 4), 21_590.0);
        assert_eq!(floor_to_digits(600.0, 6), 600.0);
        assert_eq!(floor_to_digits(2.3, 6), 2.3);
        assert_eq!(floor_to_digits(0.012_345_678, 6), 0.012_345_6);
        assert_eq!(floor_to_digits(123_456_789.0, 6), 123_456_000.0);
        for i in 1..10_000 {
            let value = 0.037 * f64::from(i).powf(1.7);
            let floored = floor_to_digits(value, 6);
            assert!(floored <= value * (1.0 + 1e-15) && floored > value * (1.0 - 1e-5), "{value}");
        }
    }

    #[test]
    fn feeds_have_no_more_places_than_the_control_reads() {
        assert_eq!(floor_to(0.012_345, 4, 3), 0.012);
        assert_eq!(floor_to(0.000_9, 4, 3), 0.0);
        assert_eq!(floor_to(12_345.6, 4, 3), 12_340.0);
        assert_eq!(ceil_to(0.012_345, 6, 4), 0.0124);
        assert_eq!(ceil_to(0.25, 6, 4), 0.25);
        assert_eq!(ceil_to(123_456.7, 4, 4), 123_500.0);
    }

    #[test]
    fn feeds_are_written_with_their_digits() {
        assert_eq!(digits(21_600.0, 6), "21600.0");
        assert_eq!(digits(0.012_345_6, 6), "0.0123456");
        assert_eq!(digits(123_456_000.0, 6), "123456000.0");
    }
}
