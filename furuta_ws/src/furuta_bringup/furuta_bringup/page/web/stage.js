// The stage: the pendulum in 3D, its swing on the floor, torque and friction as arrows round the column.
// y is up; φ turns about y, and θ > 0 leans towards growing φ. Arm and pendulum have the proportions of the rig.
import {
  CapsuleGeometry, CircleGeometry, ConeGeometry, CylinderGeometry, DirectionalLight, DoubleSide, Group, HemisphereLight,
  LatheGeometry, Line, LineDashedMaterial, BufferGeometry, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera,
  RingGeometry, Scene, SphereGeometry, TubeGeometry, Vector2, Vector3, Curve, WebGLRenderer,
} from "./three.js";

const REACH = 1.95;  // of arm and pendulum together
const ABOVE = 0.1;  // a pendulum that hangs stays so far above the floor
const BETWEEN = { nearest: 2, farthest: 20 };  // of the camera, which sees all
const ZOOM = [0.4, 2];
const LIGHT = new Vector3(2.2, 5, 2.6);
const ARROW = { radius: 0.25, most: 2.6, perVolt: 4, least: 0.08 };
const GRABBED = 26;  // how near to a rod a pointer grabs it [pixels]

export class Stage {
  constructor(host, antialias, lengths) {
    this.host = host;
    this.lookFromStart();
    this.camera = new PerspectiveCamera(30, 1, 0.1, 50);
    this.build(lengths);
    this.detail = 1;
    this.renew(antialias);
  }

  lookFromStart() {
    this.view = { turn: 0.7, height: 0.42, zoom: 1 };
  }

  zoom(factor) {
    this.view.zoom = Math.min(ZOOM[1], Math.max(ZOOM[0], this.view.zoom * factor));
  }

  // Draws the pendulum of another rig, with its lengths of arm and pendulum.
  setLengths(lengths) {
    if (String(lengths) === String(this.lengths)) return;
    this.scene.traverse((each) => each.geometry?.dispose());
    this.build(lengths);
    this.paint();
  }

  // A canvas with or without smooth edges; it cannot be changed later.
  renew(antialias) {
    this.renderer?.dispose();
    this.canvas?.remove();
    this.canvas = Object.assign(document.createElement("canvas"), { id: "view" });
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "The pendulum on its arm; drag to turn the view");
    this.host.prepend(this.canvas);
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias, alpha: true, preserveDrawingBuffer: false });
    this.size = "";
    this.paint();
  }

  // Whether no graphics processor draws.
  get bySoftware() {
    const gl = this.renderer.getContext(), about = gl.getExtension("WEBGL_debug_renderer_info");
    return Boolean(about) && /swiftshader|llvmpipe|software/i.test(gl.getParameter(about.UNMASKED_RENDERER_WEBGL));
  }

  paint() {
    const style = getComputedStyle(document.documentElement);
    for (const [material, name] of this.tinted) material.color.set(style.getPropertyValue(`--${name}`).trim());
  }

  material(Kind, colour, options = {}) {
    const made = new Kind(options);
    this.tinted.push([made, colour]);
    return made;
  }

  build(lengths) {
    const scale = REACH / (lengths[0] + lengths[1]), [arm, pendulum] = lengths.map((each) => scale * each);
    Object.assign(this, { lengths, arm, pendulum, hub: pendulum + ABOVE, scene: new Scene(), tinted: [], size: "", swept: "" });
    this.furnish();
  }

  furnish() {
    const { arm: reach, pendulum: length, hub } = this;
    const solid = (colour) => this.material(MeshLambertMaterial, colour);
    const flat = (colour, options) => this.material(MeshBasicMaterial, colour, options);
    const add = (parent, geometry, material, [x, y, z] = [0, 0, 0], turn = 0) => {
      const mesh = new Mesh(geometry, material);
      mesh.position.set(x, y, z);
      mesh.rotation.z = turn;
      parent.add(mesh);
      return mesh;
    };
    const { scene } = this;
    scene.add(new HemisphereLight(0xffffff, 0x8793a0, 1.7));
    const sun = new DirectionalLight(0xffffff, 1.7);
    sun.position.copy(LIGHT);
    scene.add(sun);
    this.addScale(flat("was"), reach + 0.05);
    const metal = solid("metal"), dark = solid("dark-metal"), arm = solid("arm"), pendulum = solid("bob");
    const top = hub - 0.07;
    const foot = [[0, 0], [0.34, 0], [0.3, 0.07], [0.13, 0.07], [0.13, top - 0.07], [0.16, top - 0.06], [0.16, top], [0, top]];
    const standing = add(scene, new LatheGeometry(foot.map(([x, y]) => new Vector2(x, y)), 40), metal);
    standing.material.side = DoubleSide;
    const [turn, swing] = [new Group(), new Group()];
    turn.position.y = hub;
    swing.position.x = reach;
    turn.add(swing);
    add(turn, new CylinderGeometry(0.1, 0.1, 0.14, 40), arm);
    add(turn, new CapsuleGeometry(0.05, reach - 0.15, 8, 24), arm, [reach / 2 - 0.05, 0, 0], Math.PI / 2);
    add(turn, new CylinderGeometry(0.075, 0.075, 0.16, 32), dark, [reach - 0.08, 0, 0], Math.PI / 2);
    add(swing, new CylinderGeometry(0.022, 0.026, length - 0.07, 20), pendulum, [0, length / 2, 0]);
    add(swing, new SphereGeometry(0.085, 32, 24), pendulum, [0, length, 0]);
    this.addShadow(turn, standing, flat("shadow"));
    const plumb = new BufferGeometry().setFromPoints([new Vector3(reach, 0.12, 0), new Vector3(reach, length + 0.3, 0)]);
    const line = new Line(plumb, this.material(LineDashedMaterial, "faint", { dashSize: 0.04, gapSize: 0.035 }));
    line.computeLineDistances();
    turn.add(line);
    scene.add(turn);
    Object.assign(this, { turn, swing });
    this.sector = add(scene, new RingGeometry(), flat("arm", { transparent: true, opacity: 0.25, side: DoubleSide, depthWrite: false }));
    this.sector.rotation.x = -Math.PI / 2;
    this.sector.position.y = 0.008;
    this.torque = this.addArrow(flat("command", { side: DoubleSide }), 0.65 * hub);
    this.friction = this.addArrow(flat("friction", { side: DoubleSide }), 0.36 * hub);
  }

  // A circle on the floor with a mark every 5 degrees.
  addScale(material, radius) {
    const ring = new Mesh(new RingGeometry(radius, radius + 0.007, 96), material), outside = radius + 0.007;
    const group = new Group();
    group.add(ring);
    for (let i = 0; i < 72; i++) {
      const size = i % 6 ? 0.03 : 0.07;
      const mark = new Mesh(new CircleGeometry(0.5, 4, Math.PI / 4), material);
      mark.scale.set(size * Math.SQRT2, 0.008 * Math.SQRT2, 1);
      const a = (i * Math.PI) / 36;
      mark.rotation.z = a;
      mark.position.set((outside + size / 2) * Math.cos(a), (outside + size / 2) * Math.sin(a), 0);
      group.add(mark);
    }
    group.rotation.x = -Math.PI / 2;
    group.position.y = 0.006;
    this.scene.add(group);
  }

  // Shadows are the same bodies pressed on the floor along the light: no picture of depths is needed.
  addShadow(turn, standing, material) {
    const pressed = new Group();
    pressed.matrixAutoUpdate = false;
    const { x, y, z } = LIGHT;
    pressed.matrix = new Matrix4().set(1, -x / y, 0, 0, 0, 0, 0, 0.003, 0, -z / y, 1, 0, 0, 0, 0, 1);
    this.shadow = turn.clone();
    pressed.add(this.shadow, standing.clone());
    pressed.traverse((each) => { if (each.isMesh) each.material = material; });
    material.side = DoubleSide;
    this.scene.add(pressed);
  }

  // An arrow round the column at a height: `set` of a voltage tells its length and direction.
  addArrow(material, height) {
    class Arc extends Curve {
      getPoint(t, target = new Vector3()) {
        const a = t * ARROW.most;
        return target.set(ARROW.radius * Math.cos(a), 0, -ARROW.radius * Math.sin(a));
      }
    }
    const segments = 52, group = new Group();
    const tube = new Mesh(new TubeGeometry(new Arc(), segments, 0.018, 8), material);
    const each = tube.geometry.index.count / segments;
    const tip = new Mesh(new ConeGeometry(0.055, 0.15, 20), material);
    group.add(tube, tip);
    group.position.y = height;
    group.rotation.y = -0.87;
    this.scene.add(group);
    return (voltage) => {
      const angle = Math.min(ARROW.most, ARROW.perVolt * Math.abs(voltage));
      group.visible = angle > ARROW.least;
      group.scale.z = Math.sign(voltage) || 1;
      const n = Math.round((angle / ARROW.most) * segments), end = (n / segments) * ARROW.most;
      tube.geometry.setDrawRange(0, n * each);
      tip.position.set(ARROW.radius * Math.cos(end), 0, -ARROW.radius * Math.sin(end));
      tip.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(-Math.sin(end), 0, -Math.cos(end)));
    };
  }

  // The words at the bottom of the stage, and on a narrow one those at the top, are left free.
  place() {
    const width = this.host.clientWidth, height = this.host.clientHeight, { camera, view } = this;
    const top = width < 500 ? 90 : 0, free = Math.max(this.host.querySelector(".foot").offsetTop - top, height / 3);
    const size = `${width} ${height} ${free} ${top} ${this.detail} ${devicePixelRatio} ${Object.values(view)}`;
    if (size === this.size) return;
    this.size = size;
    this.renderer.setPixelRatio(this.detail * Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    camera.aspect = width / free;
    camera.clearViewOffset();
    let { nearest, farthest } = BETWEEN;
    while (farthest - nearest > 0.01) {
      const far = (nearest + farthest) / 2;
      if (this.seesAll(far)) farthest = far;
      else nearest = far;
    }
    this.look(farthest * view.zoom);
    camera.setViewOffset(width, free, 0, -top, width, height);
  }

  look(far) {
    const { camera, view: { turn, height } } = this, middle = new Vector3(0, (this.hub + this.pendulum) / 2, 0);
    camera.position.set(Math.cos(height) * Math.sin(turn), Math.sin(height), Math.cos(height) * Math.cos(turn));
    camera.position.multiplyScalar(far).add(middle);
    camera.lookAt(middle);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }

  // Whether the circle on the floor and the pendulum, wherever its arm turns, are in sight from so far.
  seesAll(far) {
    this.look(far);
    const rims = [[this.arm + 0.15, 0], [this.arm, this.hub + this.pendulum + ABOVE]];
    return rims.every(([radius, y]) => Array.from({ length: 16 }, (_, i) => (i * Math.PI) / 8).every((a) => {
      const seen = new Vector3(radius * Math.cos(a), y, radius * Math.sin(a)).project(this.camera);
      return Math.max(Math.abs(seen.x), Math.abs(seen.y)) < 0.98;
    }));
  }

  // Draws a state: angles, the ends of the swing [rad], voltage and friction [V].
  draw({ phi, theta, from, to, u, friction }) {
    this.place();
    this.turn.rotation.y = this.shadow.rotation.y = phi;
    this.swing.rotation.x = this.shadow.children[0].rotation.x = -theta;
    const swept = `${from.toFixed(3)} ${to.toFixed(3)}`;
    if (swept !== this.swept) {
      this.swept = swept;
      this.sector.geometry.dispose();
      this.sector.geometry = new RingGeometry(0.36, this.arm + 0.03, 48, 1, from, Math.min(2 * Math.PI, Math.max(0.012, to - from)));
    }
    this.torque(u || 0);
    this.friction(-friction || 0);  // unknown on a rig
    this.renderer.render(this.scene, this.camera);
  }

  // A point of arm (at its end) or pendulum (at its bob) at angles, in pixels of the canvas.
  pixels(part, phi, theta, share = 1) {
    const end = new Vector3(this.arm, 0, 0), length = share * this.pendulum;
    if (part === "pendulum") end.add(new Vector3(0, length * Math.cos(theta), -length * Math.sin(theta)));
    else end.multiplyScalar(share);
    end.applyAxisAngle(new Vector3(0, 1, 0), phi).add(new Vector3(0, this.hub, 0)).project(this.camera);
    return [((1 + end.x) / 2) * this.host.clientWidth, ((1 - end.y) / 2) * this.host.clientHeight];
  }

  // What is under the pointer: "pendulum", "arm" or nothing.
  under([x, y], phi, theta) {
    const near = (part, share) => {
      const [px, py] = this.pixels(part, phi, theta, share);
      return Math.hypot(px - x, py - y) < GRABBED;
    };
    const shares = [1, 0.85, 0.7, 0.55, 0.4, 0.25];
    return ["pendulum", "arm"].find((part) => shares.some((share) => near(part, share)));
  }

  // How far [rad] the pointer is ahead of what it holds.
  ahead(part, [x, y], phi, theta) {
    const small = 0.02, [x0, y0] = this.pixels(part, phi, theta);
    const [x1, y1] = part === "arm" ? this.pixels(part, phi + small, theta) : this.pixels(part, phi, theta + small);
    const [a, b] = [(x1 - x0) / small, (y1 - y0) / small];
    return ((x - x0) * a + (y - y0) * b) / Math.max(a * a + b * b, 400);
  }
}
