// Light or dark: the system's choice, unless the user chooses.

import { Changing } from "./changing";

export type Theme = "light" | "dark";

/** Colours of the drawings on canvases and the stage; those of the page are in style.css. */
export interface Palette {
  background: string;
  floor: string;
  floorAxis: string;
  surface: string;
  mesh: string;
  collider: string;
  /** Takes that are drawn behind the scene. */
  ghosts: [string, string];
  /** The two colours of the thesis, fig. 12: deformation and force. */
  deformation: string;
  force: string;
  rim: string;
  /** Held nodes. */
  pin: string;
  /** Nodes that colliders push. */
  touch: string;
  ink: string;
  faint: string;
  panel: string;
  /**
   * Distinguishable from each other and from the panel for every kind of colour vision; a test
   * checks this.
   */
  curves: string[];
  /** The part of the ramp of velocities that stands out from the panel. */
  shades: [number, number];
  accent: string;
}

const palettes: Record<Theme, Palette> = {
  dark: {
    background: "#15191f", floor: "#2a313b", floorAxis: "#3b4552", surface: "#b9c2cf", mesh: "#0b0e12", collider: "#b0a294", ghosts: ["#e06cf0", "#58e0d0"],
    deformation: "#6fb1ff", force: "#ffb43a", rim: "#e9f1fb", pin: "#ff6f91", touch: "#cf8bff", ink: "#d5dce6", faint: "#5d6877", panel: "#1b2027",
    curves: ["#47b6ff", "#ff8099", "#997c08", "#80ffff", "#3e7edd", "#eeee0c"], shades: [0.12, 1], accent: "#ffb43a",
  },
  light: {
    background: "#eef1f5", floor: "#d3d9e1", floorAxis: "#b5becb", surface: "#a9b4c3", mesh: "#11161d", collider: "#a39483", ghosts: ["#b02bc4", "#0a8f8a"],
    deformation: "#1d4f9e", force: "#b85c00", rim: "#0f1722", pin: "#c2185b", touch: "#6a12c9", ink: "#1f2733", faint: "#97a2b1", panel: "#ffffff",
    curves: ["#0d3dff", "#dd3e9d", "#aa8a09", "#0c94ee", "#99087c", "#555504"], shades: [0, 0.6], accent: "#b85c00",
  },
};

export class ThemeChoice extends Changing {
  private readonly system = matchMedia("(prefers-color-scheme: light)");
  private chosen: Theme | null = null;

  constructor() {
    super();
    this.system.addEventListener("change", () => this.apply());
    this.apply();
  }

  get theme(): Theme {
    return this.chosen ?? (this.system.matches ? "light" : "dark");
  }

  get palette(): Palette {
    return palettes[this.theme];
  }

  choose(theme: Theme): void {
    this.chosen = theme;
    this.apply();
  }

  toggle(): void {
    this.choose(this.theme === "dark" ? "light" : "dark");
  }

  private apply(): void {
    document.documentElement.dataset.theme = this.theme;
    this.tell();
  }
}
