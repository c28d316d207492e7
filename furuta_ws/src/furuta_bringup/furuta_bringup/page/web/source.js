// What moves the page: Loop computes the loop here, Graph receives it from a server. Both have
//   knobs               what can be set, as Control draws it; `values`: those in force, by name
//   base                values before any scene; `change(told)`: what a step or a what-if sets, by name
//   set(values, place)  sets some of them; `place` is the scene and step that they belong to
//   own(chosen)         what has to be set later to come back to the settings in force with these
//   now, time, zero     the newest row, its time, and the time from which the page counts
//   take(samples)       the rows since the last call, in order
//   push(arm, pendulum), reset(phi, theta), pace(speed), step()
//   speeds              pairs of words and speed, null is as fast as possible; none: it cannot be set
//   swingsUp, fallAngle, encoderCounts, lengths (of arm and pendulum [m])
//   cycle               the exact cycle of the settings, null: none, "computing", undefined: not known
//   hasPlant, hasScenes whether there is a simulated plant, and all that the scenes need
//   status              title, late, notices, rig, waiting, lost
//   isHere              whether the page computes the motion itself, in step with its frames
// Columns of a row: time [s], arm angle and speed, pendulum, friction, its estimate, voltage; NaN is not known.
export const TIME = 0, PHI = 1, SPEED = 2, THETA = 3, F = 4, F_HAT = 5, U = 6, COLUMNS = 7;

export const turns = (angle) => 2 * Math.PI * Math.round(angle / (2 * Math.PI));
export const wrapped = (angle) => angle - turns(angle);
