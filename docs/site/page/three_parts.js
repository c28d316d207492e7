// What the stage uses of three.js; `python docs/site/one_page.py --library` puts it into the package.
export {
  CapsuleGeometry, CircleGeometry, ConeGeometry, CylinderGeometry, DirectionalLight, DoubleSide, Group, HemisphereLight,
  LatheGeometry, Line, LineDashedMaterial, BufferGeometry, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera,
  RingGeometry, Scene, SphereGeometry, TubeGeometry, Vector2, Vector3, Curve, WebGLRenderer,
} from "three";
