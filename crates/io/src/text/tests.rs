//! Tests of `text.rs`.

use super::*;
use proptest::prelude::*;

fn float(text: &str) -> Option<f32> {
    Cursor::new(text.as_bytes()).float()
}

#[test]
fn numbers_in_all_spellings() {
    for text in [
        "1", "-0", "2.", ".5", "+3.25", "1e2", "2.e1", "-1E-3", "16777217", "3.4e38", "1e-45",
        "1e-300",
    ] {
        assert_eq!(
            float(text).unwrap().to_bits(),
            text.parse::<f32>().unwrap().to_bits(),
            "{text}"
        );
    }
    assert_eq!(float("1e999"), Some(f32::INFINITY));
    assert!(float("nan").unwrap().is_nan() && float("-1.#IND").unwrap().is_nan());
    assert_eq!((float("-inf"), float("1.#INF00")), (Some(f32::NEG_INFINITY), Some(f32::INFINITY)));
    assert_eq!((float("abc"), float("-"), float("")), (None, None, None));
}

#[test]
fn comments_behind_names_begin_after_a_blank() {
    for (name, plain) in [("a # b", "a"), ("a b #c", "a b"), ("a\t#", "a"), ("a#b # c # d", "a#b")]
    {
        assert_eq!(without_comment(name), plain);
    }
    for name in ["", "#", "# a", "a#b", "Material #25", "ä"] {
        assert_eq!(without_comment(name), name);
    }
}

#[test]
fn an_ill_formed_number_keeps_its_head() {
    let mut cursor = Cursor::new(b"3.1+e2 7 1e");
    assert_eq!((cursor.float(), cursor.take_ill_formed()), (Some(3.1), true));
    assert_eq!((cursor.float(), cursor.take_ill_formed()), (Some(7.0), false));
    assert_eq!((cursor.float(), cursor.take_ill_formed()), (Some(1.0), true));
}

#[test]
fn foreign_spellings_of_numbers_are_read() {
    for (text, value) in [
        ("0,5", 0.5),
        ("-12,25", -12.25),
        ("1,5e-3", 1.5e-3),
        ("2.0D+00", 2.0),
        ("2d0", 2.0),
        ("-1.25d-2", -1.25e-2),
        ("1,5D1", 15.0),
        ("0.25+003", 250.0),
        ("2.-003", 0.002),
    ] {
        let mut cursor = Cursor::new(text.as_bytes());
        assert_eq!(
            (cursor.float(), cursor.take_ill_formed(), cursor.at_end()),
            (Some(value), false, true),
            "{text}"
        );
    }
    for text in ["1,2,3", "1.5,2.5", "0.5,1,2"] {
        let mut cursor = Cursor::new(text.as_bytes());
        assert_eq!(
            (cursor.float(), cursor.word()),
            (None, text.as_bytes()),
            "it may be several numbers"
        );
    }
    for (text, head) in [("1, 2", 1.0), ("2d", 2.0), ("3.1+e2", 3.1), ("2.0Dx", 2.0), ("1+22", 1.0)]
    {
        let mut cursor = Cursor::new(text.as_bytes());
        assert_eq!((cursor.float(), cursor.take_ill_formed()), (Some(head), true), "{text}");
    }
}

#[test]
fn doubles_keep_what_singles_round_away() {
    for (text, value) in [
        ("4500067.8900001", 4_500_067.890_000_1),
        ("500012,34", 500_012.34),
        ("1.5D7 2", 1.5e7),
        ("-.25#", -0.25),
    ] {
        assert_eq!(Cursor::new(text.as_bytes()).double(), Some(value), "{text}");
    }
    assert!(Cursor::new(b"nan").double().unwrap().is_nan());
    assert_eq!(
        (Cursor::new(b"1e999").double(), Cursor::new(b"x").double()),
        (Some(f64::INFINITY), None)
    );
}

#[test]
fn lines_and_continuations_are_counted() {
    let mut cursor = Cursor::new(b"a \\\r\n b # c\n\n#x\n  d\\e");
    assert_eq!((cursor.word(), cursor.word(), cursor.line()), (&b"a"[..], &b"b"[..], 2));
    assert!(cursor.at_line_end());
    assert!(cursor.next_content());
    assert_eq!((cursor.line(), cursor.word()), (5, &b"d\\e"[..]));
    assert!(!cursor.next_content());
}

#[test]
fn whatever_stands_on_a_line_is_continued() {
    let mut cursor = Cursor::new(b"v 1\\\n2 word\\\r\n 3 \\\n# c \\\nx\ng a \\\n b # c \\\ny");
    assert_eq!((cursor.word(), cursor.float(), cursor.float()), (&b"v"[..], Some(1.0), Some(2.0)));
    assert_eq!(
        (cursor.word(), cursor.float(), cursor.take_ill_formed()),
        (&b"word"[..], Some(3.0), false)
    );
    cursor.next_line();
    assert_eq!((cursor.line(), cursor.word()), (5, &b"x"[..]));
    cursor.next_line();
    let mut ahead = cursor;
    ahead.next_line();
    assert_eq!((ahead.line(), ahead.word()), (8, &b"y"[..]));
    assert_eq!((cursor.word(), &*name(cursor.rest_of_line())), (&b"g"[..], "a b # c"));
    cursor.next_line();
    assert_eq!(cursor.line(), 8);
}

#[test]
fn every_encoding_becomes_utf8() {
    let units: Vec<u16> = "v 1\né".encode_utf16().collect();
    let big: Vec<u8> = units.iter().flat_map(|u| u.to_be_bytes()).collect();
    let little: Vec<u8> = units.iter().flat_map(|u| u.to_le_bytes()).collect();
    assert_eq!(&*to_utf8(&[&[0xFE, 0xFF], &big[..]].concat()), "v 1\né".as_bytes());
    assert_eq!(&*to_utf8(&[&[0xFF, 0xFE], &little[..]].concat()), "v 1\né".as_bytes());
    assert_eq!(&*to_utf8(&little[..8]), b"v 1\n");
    assert_eq!(&*to_utf8(b"\xEF\xBB\xBFv"), b"v");
    assert_eq!(&*to_utf8(b"a\rb\r"), b"a\nb\n");
    assert_eq!(&*to_utf8(b"a\rb\r\nc\r\rd\ne\r"), b"a\nb\r\nc\n\nd\ne\n");
    for plain in ["", "a", "a\r\nb\r\n", &"a\r\n".repeat(4096), &"a\n".repeat(4096)] {
        assert!(matches!(to_utf8(plain.as_bytes()), Cow::Borrowed(_)));
    }
    for k in [0, 1, 4094, 4095, 4096, 9999] {
        let mut text = vec![b'x'; 10_000];
        text[k] = b'\r';
        let lines = to_utf8(&text).iter().position(|&b| b == b'\n');
        assert_eq!(lines, Some(k));
    }
}

#[test]
fn names_are_utf8_or_latin_1() {
    assert_eq!((name("é".as_bytes()), name(b"M\xE9tal")), ("é".into(), "Métal".into()));
    assert_eq!(name(b"a b \\\r\n  c\\\nd"), "a b c d");
}

#[test]
fn pieces_end_with_whole_lines() {
    let text = b"abc\ndef\\\nghi\njkl";
    let pieces = cut_at_lines(text, 4);
    assert_eq!(pieces, [&b"abc\ndef\\\nghi\n"[..], b"jkl"]);
    assert_eq!(pieces.concat(), text);
}

proptest! {
    #[test]
    fn floats_are_correctly_rounded(sign in "[-+]?", whole in "[0-9]{0,22}", fraction in "[0-9]{0,22}", power in -60i32..60) {
        prop_assume!(!whole.is_empty() || !fraction.is_empty());
        for text in [format!("{sign}{whole}.{fraction}"), format!("{sign}{whole}.{fraction}e{power}")] {
            let expected: f32 = text.parse().unwrap();
            prop_assert_eq!(float(&text).unwrap().to_bits(), expected.to_bits(), "{}", text);
        }
    }

    #[test]
    fn printed_floats_come_back(bits in any::<u32>()) {
        let value = f32::from_bits(bits);
        prop_assume!(value.is_finite());
        prop_assert_eq!(float(&format!("{value}")).unwrap().to_bits(), bits);
        prop_assert_eq!(float(&format!("{value:e}")).unwrap().to_bits(), bits);
    }
}
