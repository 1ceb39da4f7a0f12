//! The phases in which scenes start, for printed code, which decides none itself.

use dalembert_symbolic::lower::Program;
use dalembert_symbolic::model::Contact;

use super::load::Loaded;
use crate::{Settings, enter_initial_phase};

/// Puts scenes in the phases in which their runs begin with the file's parameters, and contacts in the directions in which they slide there; a scene
/// whose start decides no phase stays in its own.
pub fn decide(program: &mut Program, loaded: &Loaded) {
    let model = &mut program.model;
    let directions: Vec<usize> = model.contacts.iter().flat_map(Contact::held).collect();
    for (place, scene) in model.scenes.iter_mut().enumerate() {
        let mut system = loaded.system.boxed_clone();
        for (parameter, value) in system.scene_parameters(place) {
            system.set_parameter(parameter, value);
        }
        let settings = Settings::of_scene(&*system, place);
        let Ok(phase) = enter_initial_phase(&mut *system, &settings) else { continue };
        scene.phase = phase;
        for held in &directions {
            scene.memory[*held] = model.graph.float(system.memory()[*held]);
        }
    }
}
