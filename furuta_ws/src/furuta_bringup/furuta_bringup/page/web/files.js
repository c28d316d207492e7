// Files that the page saves: a picture of what it shows, and the numbers of the last seconds.
const COLUMNS = ["time_s", "phi_rad", "phi_dot_rad_s", "theta_rad", "friction_v", "friction_estimate_v", "command_v"];

function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Rows of COLUMNS as CSV, with all their digits.
export function numbersFile(rows) {
  save("furuta.csv", new Blob([[COLUMNS, ...rows].map((row) => `${row.join(",")}\n`).join("")], { type: "text/csv" }));
}

// The texts in some elements, each with its box and style.
function* texts(elements) {
  for (const element of elements) {
    const walker = document.createTreeWalker(element, NodeFilter.SHOW_TEXT), range = document.createRange();
    while (walker.nextNode()) {
      range.selectNodeContents(walker.currentNode);
      const box = range.getBoundingClientRect();
      if (box.width) yield [walker.currentNode.data.trim(), box, getComputedStyle(walker.currentNode.parentElement)];
    }
  }
}

// Stage and charts as they are, with their words and a caption, as PNG. The stage must just have been drawn.
export function pictureFile(caption) {
  const style = getComputedStyle(document.documentElement), main = document.querySelector("main").getBoundingClientRect();
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const boxes = [...document.querySelectorAll("#stage, figure")].map((each) => [each, each.getBoundingClientRect()]);
  const right = Math.max(...boxes.map(([, box]) => box.right)), bottom = Math.max(...boxes.map(([, box]) => box.bottom));
  const picture = document.createElement("canvas"), c = picture.getContext("2d"), scale = 2;
  picture.width = scale * (right - main.left + 16);
  picture.height = scale * (bottom - main.top + 50);
  c.scale(scale, scale);
  c.fillStyle = colour("page");
  c.fillRect(0, 0, picture.width, picture.height);
  c.translate(-main.left, 34 - main.top);
  for (const [, box] of boxes) {
    c.fillStyle = colour("card");
    c.fillRect(box.left, box.top, box.width, box.height);
  }
  for (const canvas of document.querySelectorAll("main canvas")) {
    const box = canvas.getBoundingClientRect();
    c.drawImage(canvas, box.left, box.top, box.width, box.height);
  }
  c.textBaseline = "middle";
  for (const [words, box, { fontWeight, fontSize, fontFamily, color }] of texts(document.querySelectorAll(".big, .key, figcaption"))) {
    Object.assign(c, { font: `${fontWeight} ${fontSize} ${fontFamily}`, fillStyle: color });
    c.fillText(words, box.left, box.top + box.height / 2);
  }
  Object.assign(c, { font: "600 15px system-ui, sans-serif", fillStyle: colour("ink") });
  c.fillText(caption, main.left + 16, main.top - 16);
  picture.toBlob((blob) => save("furuta.png", blob));
}
