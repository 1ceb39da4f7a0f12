//! Links and joints as the tree that they are, or why they are none.

use std::collections::HashMap;
use std::ops::Range;

use dalembert_symbolic::diagnose::{Place, Problem, did_you_mean};

use super::problems;
use super::robot::{Joint, Kind, Robot};

/// How the joints hang together.
#[derive(Debug)]
pub struct Tree {
    /// The link that nothing moves.
    pub root: usize,
    /// Joints, each after the one above it, each branch to its end before the next.
    pub order: Vec<usize>,
    /// Of each joint its parent and child link.
    pub ends: Vec<[usize; 2]>,
    /// Of each link the joint above it.
    pub above: Vec<Option<usize>>,
    /// Of each joint where it and all that it moves stand in `order`.
    pub beyond: Vec<Range<usize>>,
}

impl Tree {
    /// The links that a joint moves.
    pub fn moved(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        self.order[self.beyond[joint].clone()].iter().map(|inner| self.ends[*inner][1])
    }

    /// The joints that hang on a link.
    pub fn below(&self, link: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.ends.len()).filter(move |joint| self.ends[*joint][0] == link)
    }
}

/// Puts links and joints together; `None` where they are no tree, which is told.
pub fn build(robot: &Robot<'_>, problems: &mut Vec<Problem>) -> Option<Tree> {
    let before = problems.len();
    let links = index(robot.links.iter().map(|link| (link.name, &link.place)), "link", problems);
    index(robot.joints.iter().map(|joint| (joint.name, &joint.place)), "joint", problems);
    if robot.links.is_empty() {
        problems.push(problems::no_links(robot.place.clone()));
        return None;
    }
    let ends: Vec<[Option<usize>; 2]> = robot
        .joints
        .iter()
        .map(|joint| [&joint.parent, &joint.child].map(|(name, place)| known(&links, joint, name, place, problems)))
        .collect();
    let mut above: Vec<Option<usize>> = vec![None; robot.links.len()];
    for (joint, [_, child]) in ends.iter().enumerate() {
        let Some(child) = *child else { continue };
        match above[child] {
            Some(first) => {
                let place = robot.joints[joint].child.1.clone();
                problems.push(problems::two_parents(place, robot.links[child].name, robot.joints[first].name));
            }
            None => above[child] = Some(joint),
        }
    }
    if problems.len() > before {
        return None;
    }
    let ends: Vec<[usize; 2]> = ends.iter().filter_map(|[parent, child]| Some([(*parent)?, (*child)?])).collect();
    let roots: Vec<usize> = (0..above.len()).filter(|link| above[*link].is_none()).collect();
    for other in roots.iter().skip(1) {
        let [link, root] = [&robot.links[*other], &robot.links[roots[0]]];
        problems.push(problems::two_roots(link.place.clone(), link.name, root.name));
    }
    let (order, beyond) = walk(&roots, &ends, above.len());
    rings(robot, &ends, &above, &order, problems);
    (problems.len() == before).then(|| Tree { root: roots[0], order, ends, above, beyond })
}

fn index<'a>(
    named: impl Iterator<Item = (&'a str, &'a Place)>,
    what: &str,
    problems: &mut Vec<Problem>,
) -> HashMap<&'a str, usize> {
    let mut found = HashMap::new();
    for (position, (name, place)) in named.enumerate() {
        if found.insert(name, position).is_some() {
            problems.push(problems::twice(place.clone(), what, name));
        }
    }
    found
}

fn known(
    links: &HashMap<&str, usize>,
    joint: &Joint<'_>,
    name: &str,
    place: &Place,
    problems: &mut Vec<Problem>,
) -> Option<usize> {
    let found = links.get(name).copied();
    if found.is_none() {
        let mut names: Vec<&str> = links.keys().copied().collect();
        names.sort_unstable();
        let near = did_you_mean(name, names);
        let help = match near.is_empty() {
            true => format!("write `<link name=\"{}\"/>`, or the name of one that is there", problems::shown(name)),
            false => near,
        };
        problems.push(problems::unknown_link(place.clone(), joint.name, name, help));
    }
    found
}

/// Down from the roots, without recursion: a file may nest as deep as it likes.
fn walk(roots: &[usize], ends: &[[usize; 2]], links: usize) -> (Vec<usize>, Vec<Range<usize>>) {
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); links];
    for (joint, [parent, _]) in ends.iter().enumerate() {
        below[*parent].push(joint);
    }
    let mut order = Vec::new();
    let mut beyond = vec![0..0; ends.len()];
    // The last is next; a joint stands a second time to be left.
    let mut next: Vec<(usize, bool)> = Vec::new();
    for root in roots {
        next.extend(below[*root].iter().rev().map(|joint| (*joint, false)));
        while let Some((joint, left)) = next.pop() {
            if left {
                beyond[joint].end = order.len();
                continue;
            }
            beyond[joint].start = order.len();
            order.push(joint);
            next.push((joint, true));
            next.extend(below[ends[joint][1]].iter().rev().map(|inner| (*inner, false)));
        }
    }
    (order, beyond)
}

/// Most joints that the message of a ring names.
const NAMED: usize = 6;

/// Joints that no root leads to hang on a ring.
fn rings(
    robot: &Robot<'_>,
    ends: &[[usize; 2]],
    above: &[Option<usize>],
    order: &[usize],
    problems: &mut Vec<Problem>,
) {
    let mut seen = vec![false; ends.len()];
    for joint in order {
        seen[*joint] = true;
    }
    for start in 0..ends.len() {
        if seen[start] {
            continue;
        }
        let mut path = Vec::new();
        let mut at = start;
        while !seen[at] {
            seen[at] = true;
            path.push(at);
            match above[ends[at][0]] {
                Some(next) => at = next,
                None => break,
            }
        }
        // A path that ends on an earlier one has told of its ring already.
        let Some(first) = path.iter().position(|joint| *joint == at) else { continue };
        let ring = &path[first..];
        let mut names: Vec<String> = ring
            .iter()
            .rev()
            .take(NAMED)
            .map(|joint| format!("`{}`", problems::shown(robot.joints[*joint].name)))
            .collect();
        if ring.len() > NAMED {
            names.push("…".to_owned());
        }
        problems.push(problems::ring(robot.joints[ring[ring.len() - 1]].place.clone(), &names.join(", ")));
    }
}

/// Of each joint that follows another one which, by its place; told where it cannot be followed.
pub fn mimics(robot: &Robot<'_>, problems: &mut Vec<Problem>) -> Vec<Option<usize>> {
    let names: HashMap<&str, usize> = robot.joints.iter().enumerate().map(|(at, joint)| (joint.name, at)).collect();
    let moves = |joint: &Joint<'_>| matches!(joint.kind, Kind::Turn | Kind::Slide);
    let found: Vec<Option<usize>> = robot
        .joints
        .iter()
        .map(|joint| {
            let mimic = joint.mimic.as_ref()?;
            let wrong = |why: &str, help: String| Some(problems::bad_mimic(mimic.place.clone(), joint.name, why, help));
            let other = names.get(mimic.joint).copied();
            let problem = match other.map(|other| &robot.joints[other]) {
                _ if !moves(joint) => wrong(
                    &format!("it is {} itself", joint.kind_name),
                    "revolute, continuous and prismatic joints mimic others".to_owned(),
                ),
                None => {
                    let near = did_you_mean(mimic.joint, robot.joints.iter().map(|joint| joint.name));
                    let why = format!("there is no joint `{}`", problems::shown(mimic.joint));
                    wrong(&why, if near.is_empty() { "name a joint of this robot".to_owned() } else { near })
                }
                Some(target) if !moves(target) => wrong(
                    &format!("`{}` is {}", problems::shown(target.name), target.kind_name),
                    "it mimics a revolute, continuous or prismatic joint".to_owned(),
                ),
                Some(_) => None,
            };
            let refused = problem.is_some();
            problems.extend(problem);
            if refused { None } else { other }
        })
        .collect();
    for (joint, _) in found.iter().enumerate().filter(|(_, other)| other.is_some()) {
        if driver(&found, joint).is_none() {
            let place = robot.joints[joint].mimic.as_ref().map_or_else(Default::default, |mimic| mimic.place.clone());
            let help = "one of them moves by itself: take its `<mimic>` out".to_owned();
            let why = "what it follows follows it";
            problems.push(problems::bad_mimic(place, robot.joints[joint].name, why, help));
        }
    }
    found
}

/// The joint that moves by itself at the end of those that a joint follows; `None` where they go round.
pub fn driver(mimics: &[Option<usize>], joint: usize) -> Option<usize> {
    let mut at = joint;
    for _ in 0..=mimics.len() {
        match mimics[at] {
            Some(next) => at = next,
            None => return Some(at),
        }
    }
    None
}
