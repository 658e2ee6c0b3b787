//! Values of arguments: sizes, windows, pixel filters, settings.

use mipless::PixelFilter;
use mipless_runtime::lit::Sun;
use mipless_runtime::view::Size;

/// The longest side of a picture, in pixels: a few rows of it are held in memory.
pub(crate) const LONGEST: u32 = 1 << 20;
/// The widest Gaussian pixel filter, as its standard deviation in pixels.
const WIDEST: f32 = 64.0;

/// Reads `1280x720`.
pub(crate) fn size(text: &str) -> Result<Size, String> {
    let form = || format!("write WIDTHxHEIGHT, each from 1 to {LONGEST} pixels");
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(form)?;
    let side = |text: &str| {
        let side: u32 = text.trim().parse().map_err(|_| form())?;
        if (1..=LONGEST).contains(&side) {
            Ok(side)
        } else {
            Err(form())
        }
    };
    Ok(Size::new(side(width)?, side(height)?))
}

/// Reads `2,0/8x4`: a column and a row, of so many columns and rows.
pub(crate) fn tile(text: &str) -> Result<[[u32; 2]; 2], String> {
    let form = || "write COLUMN,ROW/COLUMNSxROWS, counted from 0, such as 2,0/8x4".to_owned();
    let pair = |text: &str, between: &[char]| {
        let (first, second) = text.split_once(between)?;
        Some([first.trim().parse().ok()?, second.trim().parse().ok()?])
    };
    let (place, count) = text.split_once('/').ok_or_else(form)?;
    let place = pair(place, &[',']).ok_or_else(form)?;
    let count = pair(count, &['x', 'X', '×']).ok_or_else(form)?;
    if place[0] >= count[0] || place[1] >= count[1] {
        return Err(format!("there is no such tile: {}", form()));
    }
    Ok([place, count])
}

/// Reads `0,0,1,1`.
pub(crate) fn window(text: &str) -> Result<[f64; 4], String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|number| number.trim().parse().ok())
        .collect();
    let window: Option<[f64; 4]> = numbers.and_then(|numbers| numbers.try_into().ok());
    let window = window
        .filter(|window| window.iter().all(|x| x.is_finite()))
        .ok_or("write X0,Y0,X1,Y1: the corners that the picture shows")?;
    if window[0] == window[2] || window[1] == window[3] {
        return Err("the window has no area".to_owned());
    }
    Ok(window)
}

/// Reads `120,30`: where the sun stands.
pub(crate) fn sun(text: &str) -> Result<Sun, String> {
    let form = || "write AZIMUTH,ELEVATION in degrees, such as 120,30".to_owned();
    let (azimuth, elevation) = text.split_once(',').ok_or_else(form)?;
    let degrees = |text: &str| {
        let number: f64 = text.trim().parse().map_err(|_| form())?;
        number.is_finite().then_some(number).ok_or_else(form)
    };
    let sun = Sun {
        azimuth: degrees(azimuth)?,
        elevation: degrees(elevation)?,
    };
    if sun.elevation.abs() > 90.0 {
        return Err("an elevation is at most 90 degrees".to_owned());
    }
    Ok(sun)
}

/// Reads `gaussian:0.5` or `box`.
pub(crate) fn pixel_filter(text: &str) -> Result<PixelFilter, String> {
    let form = || {
        format!("write `box`, or `gaussian:SD` with a standard deviation from 0 to {WIDEST} pixels")
    };
    match text {
        "box" => Ok(PixelFilter::Box),
        "gaussian" => Ok(PixelFilter::default()),
        _ => {
            let sd = text.strip_prefix("gaussian:").ok_or_else(form)?;
            let sd: f32 = sd.parse().map_err(|_| form())?;
            if (0.0..=WIDEST).contains(&sd) {
                Ok(PixelFilter::Gaussian(sd))
            } else {
                Err(form())
            }
        }
    }
}

/// Reads a number above 0, such as a tolerance.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("write a number above 0".to_owned()),
    }
}

/// Reads `INPUT=VALUE`; the value is read later, when the type is known.
pub(crate) fn setting(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.to_owned()))
        }
        _ => Err("write INPUT=VALUE".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_sensible() {
        assert_eq!(size("1280x720"), Ok(Size::new(1280, 720)));
        for wrong in ["0x5", "5x0", "5", "x", "-1x5", "1048577x1", "99999999999x1"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(size("65536x4096"), Ok(Size::new(65_536, 4096)));
    }

    #[test]
    fn tiles_are_some_of_their_number() {
        assert_eq!(tile("2, 0/8x4"), Ok([[2, 0], [8, 4]]));
        for wrong in [
            "2,0", "8,0/8x4", "0,4/8x4", "-1,0/8x4", "a,b/1x1", "0,0/0x1", "1/2",
        ] {
            assert!(tile(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn windows_have_an_area() {
        assert_eq!(window("-1, 0,1e6,2"), Ok([-1.0, 0.0, 1e6, 2.0]));
        for wrong in [
            "0,0,1",
            "0,0,0,1",
            "0,0,nan,1",
            "0,0,1,1,1",
            "a,b,c,d",
            "0,0,inf,1",
        ] {
            assert!(window(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn suns_stand_somewhere() {
        let at = Sun {
            azimuth: -20.5,
            elevation: 30.0,
        };
        assert_eq!(sun("-20.5, 30"), Ok(at));
        for wrong in ["30", "a,b", "0,91", "nan,3", "1,2,3"] {
            assert!(sun(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn filters_are_read_as_they_are_named() {
        for name in ["box", "gaussian:0.5", "gaussian:2"] {
            assert_eq!(
                pixel_filter(name).map(|filter| filter.to_string()),
                Ok(name.to_owned())
            );
        }
        for wrong in ["gaussian:-1", "gaussian:nan", "tent", "gaussian:"] {
            assert!(pixel_filter(wrong).is_err(), "{wrong}");
        }
    }
}
