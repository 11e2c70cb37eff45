#![no_main]

use libfuzzer_sys::fuzz_target;
use system_tests::bad_input::Kind;

fuzz_target!(|bytes: &[u8]| Kind::Csv.try_all(bytes));
