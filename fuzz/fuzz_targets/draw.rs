#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| vitral_testkit::fuzz::draw(bytes));
