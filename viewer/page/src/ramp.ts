// Colours for numbers: ramps with evenly rising lightness, made in OKLab.

export type Rgb = [number, number, number];

const fromHex = (hex: string): Rgb => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255) as Rgb;
const toLinear = (value: number) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
const toGamma = (value: number) => (value <= 0.0031308 ? value * 12.92 : 1.055 * value ** (1 / 2.4) - 0.055);

// B. Ottosson, "A perceptual color space for image processing" (2020).
function toOklab(rgb: Rgb): Rgb {
  const [r, g, b] = rgb.map(toLinear);
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function linearFromOklab([lightness, a, b]: Rgb): Rgb {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ].map((value) => Math.min(Math.max(value, 0), 1)) as Rgb;
}

/** 256 colours between stops, in linear light, as three.js expects vertex colours. */
export class Ramp {
  readonly colours = new Float32Array(256 * 3);

  constructor(stops: string[]) {
    const labs = stops.map((stop) => toOklab(fromHex(stop)));
    for (let k = 0; k < 256; ++k) {
      const place = (k / 255) * (labs.length - 1);
      const first = Math.min(Math.floor(place), labs.length - 2);
      const share = place - first;
      const lab = labs[first].map((value, c) => value + share * (labs[first + 1][c] - value)) as Rgb;
      this.colours.set(linearFromOklab(lab), 3 * k);
    }
  }

  /** The colour at `share`, 0 to 1. */
  cssAt(share: number): string {
    const k = 3 * Math.round(255 * Math.min(Math.max(share, 0), 1));
    return `rgb(${Array.from(this.colours.subarray(k, k + 3), (value) => Math.round(255 * toGamma(value))).join(" ")})`;
  }

  /** The ramp as the background of an element. */
  css(): string {
    const stops: string[] = [];
    for (let k = 0; k < 256; k += 15) stops.push(this.cssAt(k / 255));
    return `linear-gradient(to right, ${stops.join(", ")})`;
  }
}

/** Rest is calm and grey-blue, the peak is warm and bright. */
export const displacementRamp = new Ramp(["#68778c", "#4587ab", "#43ab94", "#b9cf5e", "#ffe08a"]);
/** Against the normal, rest, along the normal. */
export const signedRamp = new Ramp(["#2350b8", "#7ba0dd", "#c6c9cf", "#ea9a76", "#b3202c"]);
export const velocityRamp = new Ramp(["#6a7188", "#7a66b0", "#c05f9a", "#ee8163", "#ffd27a"]);
