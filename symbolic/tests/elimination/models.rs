// Mechanisms in which velocities are shared, of any size.
#![allow(dead_code, reason = "each test uses some of them")]

/// Links, absolute angles.
pub const ABSOLUTE: &str = r#"
name: Absolute
sizes: {n: 3}
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {"theta[i in 1..n]": rad}
points:
  "tip[0]": [0, 0]
  "tip[i in 1..n]": "tip[i-1] + l*[sin(theta[i]), -cos(theta[i])]"
bodies:
  "bar[i in 1..n]": {mass: m, inertia: m*l^2/12, angle: "theta[i]", position: "(tip[i-1] + tip[i])/2"}
gravity: [0, -g]
"#;

/// Links of their own masses and lengths, absolute angles.
pub const UNLIKE: &str = r#"
name: Unlike
sizes: {n: 3}
parameters: {"m[i in 1..n]": 1 kg, "l[i in 1..n]": 1 m, g: 10 m/s^2}
coordinates: {"theta[i in 1..n]": rad}
points:
  "tip[0]": [0, 0]
  "tip[i in 1..n]": "tip[i-1] + l[i]*[sin(theta[i]), -cos(theta[i])]"
bodies:
  "bar[i in 1..n]":
    {mass: "m[i]", inertia: "m[i]*l[i]^2/12", angle: "theta[i]", position: "(tip[i-1] + tip[i])/2"}
gravity: [0, -g]
"#;

/// Balls of their own masses on massless rods, absolute angles.
pub const BALLS: &str = r#"
name: Balls
sizes: {n: 3}
parameters: {"m[i in 1..n]": 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {"theta[i in 1..n]": rad}
points:
  "tip[0]": [0, 0]
  "tip[i in 1..n]": "tip[i-1] + l*[sin(theta[i]), -cos(theta[i])]"
bodies: {"ball[i in 1..n]": {mass: "m[i]", position: "tip[i]"}}
gravity: [0, -g]
"#;

/// Links, relative angles.
pub const RELATIVE: &str = r#"
name: Relative
sizes: {n: 3}
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {"phi[i in 1..n]": rad}
define: {"theta[i in 1..n]": "sum(phi[j], j in 1..i)"}
points:
  "tip[0]": [0, 0]
  "tip[i in 1..n]": "tip[i-1] + l*[sin(theta[i]), -cos(theta[i])]"
bodies:
  "bar[i in 1..n]": {mass: m, inertia: m*l^2/12, angle: "theta[i]", position: "(tip[i-1] + tip[i])/2"}
gravity: [0, -g]
"#;

/// A chain on a cart.
pub const CART: &str = r#"
name: Cart
sizes: {n: 3}
parameters: {m: 1 kg, M: 2 kg, l: 1 m, g: 10 m/s^2}
coordinates: {x: m, "theta[i in 1..n]": rad}
points:
  "tip[0]": [x, 0]
  "tip[i in 1..n]": "tip[i-1] + l*[sin(theta[i]), -cos(theta[i])]"
bodies:
  cart: {mass: M, position: "tip[0]"}
  "bar[i in 1..n]": {mass: m, inertia: m*l^2/12, angle: "theta[i]", position: "(tip[i-1] + tip[i])/2"}
gravity: [0, -g]
"#;

/// A chain that swings in a plane that turns about the vertical: one coordinate is in the velocity of every body.
pub const TURNTABLE: &str = r#"
name: Turntable
sizes: {n: 3}
parameters: {m: 1 kg, J: 2 kg*m^2, R: 0.5 m, l: 1 m, g: 10 m/s^2}
coordinates: {psi: rad, "theta[i in 1..n]": rad}
define:
  "r[0]": R
  "r[i in 1..n]": "r[i-1] + l*sin(theta[i])"
  "z[0]": 0*l
  "z[i in 1..n]": "z[i-1] - l*cos(theta[i])"
points:
  "bob[i in 1..n]": "[r[i]*cos(psi), r[i]*sin(psi), z[i]]"
bodies:
  "ball[i in 1..n]": {mass: m, position: "bob[i]"}
kinetic_energy: J*psi'^2/2
gravity: [0, 0, -g]
"#;

/// A binary tree of links: link i hangs from link i/2.
pub const TREE: &str = r#"
name: Tree
sizes: {n: 3}
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {"theta[i in 1..n]": rad}
points:
  "tip[0]": [0, 0]
  "tip[i in 1..n]": "tip[(i - mod(i, 2))/2] + l*[sin(theta[i]), -cos(theta[i])]"
bodies:
  "bar[i in 1..n]": {mass: m, inertia: m*l^2/12, angle: "theta[i]", position: "(tip[(i - mod(i, 2))/2] + tip[i])/2"}
gravity: [0, -g]
"#;

/// Pendulums on strings in space, one below the other, in spherical angles.
pub const SPHERICAL: &str = r#"
name: Spherical
sizes: {n: 3}
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {"a[i in 1..n]": rad, "b[i in 1..n]": rad}
points:
  "p[0]": [0, 0, 0]
  "p[i in 1..n]": "p[i-1] + l*[sin(a[i])*cos(b[i]), sin(a[i])*sin(b[i]), -cos(a[i])]"
bodies: {"ball[i in 1..n]": {mass: m, position: "p[i]"}}
gravity: [0, 0, -g]
"#;

/// Bars on universal joints, one below the other.
pub const SPACE: &str = r#"
name: Space
sizes: {n: 3}
parameters: {m: 1 kg, l: 1 m, I: 0.1 kg*m^2, Ia: 0.005 kg*m^2, g: 10 m/s^2}
coordinates: {"a[i in 1..n]": rad, "b[i in 1..n]": rad}
frames:
  "F[1]": {rotate: [[x, "a[1]"], [y, "b[1]"]]}
  "F[i in 2..n]": {from: "F[i-1]", rotate: [[x, "a[i]"], [y, "b[i]"]]}
points:
  "p[0]": [0, 0, 0]
  "p[i in 1..n]": "p[i-1] - l*F[i].z"
bodies: {"bar[i in 1..n]": {mass: m, inertia: [I, I, Ia], frame: "F[i]", position: "(p[i-1] + p[i])/2"}}
gravity: [0, 0, -g]
"#;

/// Links by their energies, absolute angles.
pub const ENERGIES: &str = r#"
name: Energies
sizes: {n: 3}
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {"theta[i in 1..n]": rad}
define:
  "x[0]": 0*l
  "x[i in 1..n]": "x[i-1] + l*cos(theta[i])*theta[i]'"
  "y[0]": 0*l
  "y[i in 1..n]": "y[i-1] + l*sin(theta[i])*theta[i]'"
  "h[0]": 0*l
  "h[i in 1..n]": "h[i-1] - l*cos(theta[i])"
kinetic_energy: "sum(m*(x[i]^2 + y[i]^2)/2, i in 1..n)"
potential_energy: "sum(m*g*h[i], i in 1..n)"
"#;

/// Bars on ball joints, one below the other, each turned against the ground.
pub const BALL_JOINTS: &str = r#"
name: BallJoints
sizes: {n: 3}
parameters: {m: 1 kg, l: 1 m, I: 0.1 kg*m^2, Ia: 0.005 kg*m^2, g: 10 m/s^2}
coordinates: {"turn[i in 1..n]": rotation}
frames: {"F[i in 1..n]": {rotate: "turn[i]"}}
points:
  "p[0]": [0, 0, 0]
  "p[i in 1..n]": "p[i-1] - l*F[i].z"
bodies:
  "bar[i in 1..n]": {mass: m, inertia: [I, I, Ia], frame: "F[i]", position: "(p[i-1] + p[i])/2"}
gravity: [0, 0, -g]
"#;

/// Bars on ball joints with drag, each turned against the one above, the first one on a carriage that slides and turns, the last one on a spring.
pub const BALL_JOINTS_ON_A_CARRIAGE: &str = r#"
name: BallJointsOnACarriage
sizes: {n: 2}
parameters: {m: 1 kg, l: 1 m, I: 0.1 kg*m^2, Ia: 0.005 kg*m^2, Ix: 0.001 kg*m^2, k: 3 N/m, c: 0.2 N*m*s, g: 10 m/s^2}
coordinates: {x: m, psi: rad, "turn[i in 1..n]": rotation}
frames:
  "F[0]": {rotate: [z, psi]}
  "F[i in 1..n]": {from: "F[i-1]", rotate: "turn[i]"}
points:
  "p[0]": "[x, 0, 0] + l*F[0].x"
  "p[i in 1..n]": "p[i-1] - l*F[i].z"
bodies:
  carriage: {mass: m, inertia: [I, I, Ia], frame: "F[0]", position: "[x, 0, 0]"}
  "bar[i in 1..n]":
    {mass: m, inertia: [[I, Ix, 0], [Ix, 1.02*I, 0], [0, 0, Ia]], frame: "F[i]", position: "(p[i-1] + p[i])/2"}
gravity: [0, 0, -g]
springs: {tie: {stretch: "norm(p[n] - [l, 0, 0])", stiffness: k}}
torques: {"drag[i in 1..n]": {on: "bar[i]", torque: "-c*angular_velocity(bar[i])"}}
"#;

/// A chain of bars in the plane, each in coordinates of its own, by the constraints of its hinges.
pub const HINGES: &str = r#"
name: Hinges
sizes: {n: 3}
parameters: {m: 1 kg, l: 1 m, I: 0.1 kg*m^2, g: 10 m/s^2}
coordinates: {"x[i in 1..n]": m, "y[i in 1..n]": m, "phi[i in 1..n]": rad}
define:
  "u[i in 1..n]": "l/2*sin(phi[i])"
  "w[i in 1..n]": "l/2*cos(phi[i])"
  "ax[0]": 0*l
  "ay[0]": 0*l
  "ax[i in 1..n]": "x[i] + u[i]"
  "ay[i in 1..n]": "y[i] - w[i]"
bodies: {"bar[i in 1..n]": {mass: m, inertia: I, angle: "phi[i]", position: "[x[i], y[i]]"}}
gravity: [0, -g]
constraints: {"px[i in 1..n]": "x[i] - u[i] - ax[i-1]", "py[i in 1..n]": "y[i] + w[i] - ay[i-1]"}
scene: {guess: {"y[i in 1..n]": "-i*l"}, start: {"phi[1]": 0.5}}
"#;

/// Four-bars in absolute angles, each on the crank of the one before.
pub const FOUR_BARS: &str = r#"
name: FourBars
sizes: {n: 2}
parameters: {m: 1 kg, l1: 0.4 m, l2: 1.1 m, l3: 0.8 m, d: 0.9 m, I: 0.1 kg*m^2, g: 10 m/s^2}
coordinates: {"a[i in 1..n]": rad, "b[i in 1..n]": rad, "c[i in 1..n]": rad}
define: {"u[i in 1..n]": "l1*cos(a[i])", "v[i in 1..n]": "l1*sin(a[i])"}
points: {"p[0]": [0, 0], "p[i in 1..n]": "p[i-1] + [u[i], v[i]]"}
bodies:
  "crank[i in 1..n]": {mass: m, inertia: I, angle: "a[i]", position: "(p[i-1] + p[i])/2"}
  "coupler[i in 1..n]": {mass: m, inertia: I, angle: "b[i]", position: "p[i] + [l2/2*cos(b[i]), l2/2*sin(b[i])]"}
  "rocker[i in 1..n]": {mass: m, inertia: I, angle: "c[i]", position: "p[i-1] + [d + l3/2*cos(c[i]), l3/2*sin(c[i])]"}
gravity: [0, -g]
constraints:
  "cx[i in 1..n]": "u[i] + l2*cos(b[i]) - d - l3*cos(c[i])"
  "cy[i in 1..n]": "v[i] + l2*sin(b[i]) - l3*sin(c[i])"
scene: {guess: {"b[i in 1..n]": 0.5, "c[i in 1..n]": 1.6}, start: {"a[i in 1..n]": 0.5}}
"#;
