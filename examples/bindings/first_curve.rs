// first_curve.rs - the tip of a rotor blade over time, by the shared library. From the top:
// rustc -L build/bindings -o build/first_curve examples/bindings/first_curve.rs
use std::ffi::{CStr, CString};
use std::os::raw::{c_char, c_int, c_void};

#[link(name = "flexbeam_scene")]
extern "C" {
    fn fbs_new() -> *mut c_void;
    fn fbs_free(s: *mut c_void);
    fn fbs_open(s: *mut c_void, name: *const c_char, text: *const c_char, n: c_int, parameter: *const *const c_char, value: *const f64) -> c_int;
    fn fbs_find(s: *mut c_void, list: c_int, name: *const c_char) -> c_int;
    fn fbs_get(s: *mut c_void, list: c_int, n: c_int, index: *const c_int, value: *mut f64) -> c_int;
    fn fbs_step_to(s: *mut c_void, time: f64) -> c_int;
    fn fbs_error(s: *const c_void) -> *const c_char;
}
const OUTPUTS: c_int = 2; // FBS_OUTPUTS

fn main() {
    let file = CString::new("examples/scenes/rotor.txt").unwrap();
    let name = CString::new("tip_1").unwrap();
    unsafe {
        let rotor = fbs_new();
        let well = |status: c_int| assert!(status == 0, "{}", CStr::from_ptr(fbs_error(rotor)).to_string_lossy());
        well(fbs_open(rotor, file.as_ptr(), std::ptr::null(), 0, std::ptr::null(), std::ptr::null()));
        let (tip, mut z) = (fbs_find(rotor, OUTPUTS, name.as_ptr()), 0.0);
        for k in 0..=5 {
            well(fbs_step_to(rotor, 0.5 * f64::from(k)));
            well(fbs_get(rotor, OUTPUTS, 1, &tip, &mut z));
            println!("{:.1} s: {z} m", 0.5 * f64::from(k));
        }
        fbs_free(rotor);
    }
}
