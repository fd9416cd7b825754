// The place of a panel for the command's message about what was just tried there.

import { setAttribute } from "./arrange";
import type { Session } from "./session";

export class Problem {
  private field: HTMLElement | null = null;

  constructor(
    private readonly place: HTMLElement,
    session: Session,
  ) {
    // What was about no field is over when something else is done.
    session.onNewer(() => this.clear(null));
  }

  /** `field`: the control whose value is refused. */
  show(message: string, field: HTMLElement | null = null): void {
    this.clear();
    this.field = field;
    if (field) {
      field.setAttribute("aria-invalid", "true");
      field.setAttribute("aria-errormessage", this.place.id);
    }
    this.place.textContent = message;
    this.place.hidden = false;
  }

  /** `field`: only what is about that one, or about none. */
  clear(field = this.field): void {
    if (this.field !== field) return;
    if (this.field) for (const name of ["aria-invalid", "aria-errormessage"]) setAttribute(this.field, name, null);
    this.field = null;
    this.place.hidden = true;
    this.place.textContent = "";
  }

  /** Does it, and shows why it is refused. */
  async attempt(act: () => Promise<unknown>, field: HTMLElement | null = null): Promise<boolean> {
    try {
      await act();
      this.clear();
      return true;
    } catch (error) {
      this.show((error as Error).message, field);
      return false;
    }
  }
}
