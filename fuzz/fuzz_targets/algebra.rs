//! Fuzzes [`sidc_testing::fuzzing::attack_in_time`] as "algebra".

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sidc_testing::fuzzing::attack_in_time("algebra", data));
