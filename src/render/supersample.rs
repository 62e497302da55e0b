//! From a large picture to a small one, averaged in linear light.

use crate::io::png::Image;

/// The mean of every `times` × `times` pixels; the sides of `image` are multiples of it.
pub(super) fn averaged(image: Image, times: u32) -> Image {
    if times == 1 {
        return image;
    }
    let table = linear_table();
    let (width, height) = (image.width / times, image.height / times);
    let row = image.width as usize * 4;
    let block = times as usize * 4;
    let share = 1.0 / (times * times) as f32;
    let mut pixels = Vec::with_capacity((width * height * 4) as usize);
    for rows in image.pixels.chunks_exact(row * times as usize) {
        for x in (0..row).step_by(block) {
            let mut sum = [0.0; 3];
            for pixel in rows.chunks_exact(row).flat_map(|row| row[x..x + block].chunks_exact(4)) {
                for (sum, &byte) in sum.iter_mut().zip(pixel) {
                    *sum += table[usize::from(byte)];
                }
            }
            let [r, g, b] = sum.map(|sum| to_srgb(sum * share));
            pixels.extend([r, g, b, 255]);
        }
    }
    Image { width, height, pixels }
}

/// [`to_linear`] of every byte.
pub(super) fn linear_table() -> [f32; 256] {
    std::array::from_fn(|byte| to_linear(byte as u8))
}

/// A byte of sRGB as linear light.
pub(super) fn to_linear(byte: u8) -> f32 {
    let x = f32::from(byte) / 255.0;
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// The nearest byte of sRGB.
fn to_srgb(x: f32) -> u8 {
    let x = if x <= 0.0031308 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (255.0 * x).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_is_one_of_light() {
        // Black and white in equal parts are 50 % of the light: 188 in sRGB.
        let (black, white) = ([0, 0, 0, 255], [255; 4]);
        let grey = [70, 70, 70, 255];
        let pixels = [black, white, grey, grey, white, black, grey, grey].concat();
        let small = averaged(Image { width: 4, height: 2, pixels }, 2);
        assert_eq!(small, Image { width: 2, height: 1, pixels: [[188, 188, 188, 255], grey].concat() });
    }

    #[test]
    fn every_byte_comes_back() {
        assert!((0..=255).all(|byte| to_srgb(to_linear(byte)) == byte));
    }
}
