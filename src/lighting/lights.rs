//! The lights of a surface: none to eight, in the order they were added.

use serde::{Deserialize, Serialize};

use super::Light;

/// The most lights there may be; shaders set aside as many.
pub const MAX_LIGHTS: usize = 8;

/// Up to [`MAX_LIGHTS`] lights. Written as a list; a single light is read too, as sessions once had it.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(try_from = "Written", into = "Vec<Light>")]
pub struct Lights {
    held: [Light; MAX_LIGHTS],
    count: usize,
}

/// Lights as files have them.
#[derive(Deserialize)]
#[serde(untagged)]
enum Written {
    Many(Vec<Light>),
    One(Light),
}

/// More lights than there may be.
#[derive(Clone, Copy, Debug, thiserror::Error, PartialEq, Eq)]
#[error("{0} lights are more than the {MAX_LIGHTS} that there may be")]
pub struct TooManyLights(usize);

impl Default for Lights {
    fn default() -> Self {
        Light::DEFAULT.into()
    }
}

impl PartialEq for Lights {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl From<Light> for Lights {
    fn from(light: Light) -> Self {
        Self { held: [light; MAX_LIGHTS], count: 1 }
    }
}

impl TryFrom<&[Light]> for Lights {
    type Error = TooManyLights;

    fn try_from(lights: &[Light]) -> Result<Self, Self::Error> {
        let mut all = Self::NONE;
        lights.iter().all(|&light| all.push(light)).then_some(all).ok_or(TooManyLights(lights.len()))
    }
}

impl TryFrom<Written> for Lights {
    type Error = TooManyLights;

    fn try_from(written: Written) -> Result<Self, Self::Error> {
        match written {
            Written::One(light) => Ok(light.into()),
            Written::Many(lights) => lights.as_slice().try_into(),
        }
    }
}

impl From<Lights> for Vec<Light> {
    fn from(lights: Lights) -> Self {
        lights.as_slice().to_vec()
    }
}

impl Lights {
    /// No light.
    pub const NONE: Self = Self { held: [Light::DEFAULT; MAX_LIGHTS], count: 0 };

    /// The lights.
    pub fn as_slice(&self) -> &[Light] {
        &self.held[..self.count]
    }

    /// The lights, to be changed.
    pub fn as_mut_slice(&mut self) -> &mut [Light] {
        &mut self.held[..self.count]
    }

    /// Adds a light behind the others; false where there is no room.
    pub fn push(&mut self, light: Light) -> bool {
        let has_room = self.count < MAX_LIGHTS;
        if has_room {
            self.held[self.count] = light;
            self.count += 1;
        }
        has_room
    }

    /// Removes a light; the later ones move up.
    pub fn remove(&mut self, index: usize) {
        if index < self.count {
            self.held.copy_within(index + 1..self.count, index);
            self.count -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(azimuth_deg: f32) -> Light {
        Light { azimuth_deg, ..Light::DEFAULT }
    }

    #[test]
    fn lights_are_written_as_a_list_and_a_single_one_is_read_too() {
        let lights: Lights = [light(1.0), light(2.0)].as_slice().try_into().expect("two lights");
        let text = serde_json::to_string(&lights).expect("serialises");
        assert_eq!(serde_json::from_str::<Lights>(&text).expect("valid"), lights);
        let old: Lights = serde_json::from_str(r#"{"azimuth_deg": 7.0, "intensity": 2.0}"#).expect("valid");
        assert_eq!(old, Light { intensity: 2.0, ..light(7.0) }.into());
        let nine = serde_json::to_string(&[Light::DEFAULT; 9]).expect("serialises");
        let refused = serde_json::from_str::<Lights>(&nine).expect_err("nine are too many").to_string();
        assert!(refused.contains("9 lights are more than the 8"), "{refused}");
    }

    #[test]
    fn a_ninth_light_is_refused_and_a_removed_one_leaves_the_others_in_order() {
        let mut lights = Lights::NONE;
        assert!((0..8).all(|index| lights.push(light(index as f32))) && !lights.push(light(9.0)));
        lights.remove(2);
        lights.remove(8);
        let azimuths: Vec<f32> = lights.as_slice().iter().map(|light| light.azimuth_deg).collect();
        assert_eq!(azimuths, [0.0, 1.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    }
}
