//! Fuzzes [`sidc_testing::fuzzing::attack_in_time`] as "formats".

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sidc_testing::fuzzing::attack_in_time("formats", data));
