//! `stick3d figure`: figure files for bodies of one's own.

use stick3d_model::files::write_atomically;
use stick3d_train::format::read_mesh;
use stick3d_train::meshes::UpAxis;

use crate::args::{FigureCommand, FigureInitArguments};
use crate::failure::{Failure, Outcome};

/// Runs `stick3d figure`.
pub(crate) fn run(command: &FigureCommand) -> Outcome {
    match command {
        FigureCommand::Init(arguments) => init(arguments),
    }
}

/// Writes a figure whose joints are found on a mesh.
fn init(arguments: &FigureInitArguments) -> Outcome {
    let FigureInitArguments {
        mesh,
        preset,
        up,
        out,
    } = arguments;
    let mut file = read_mesh(mesh).map_err(Failure::input)?;
    UpAxis::from(*up).turn(&mut file.mesh.positions);
    let figure = preset.figure(&file.mesh).map_err(|error| {
        Failure::input(error).context(format!("cannot find joints on {}", mesh.display()))
    })?;
    let text = figure.to_ron().map_err(Failure::input)?;
    write_atomically(out, text.as_bytes()).map_err(Failure::output)?;
    println!(
        "{}: {} joints of {}, found on {}; look at them before training (`stick3d train --meshes`)",
        out.display(),
        figure.joint_count(),
        figure.name,
        mesh.display()
    );
    Ok(())
}
