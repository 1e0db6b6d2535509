// The address bar, which follows the situation.

import type { App } from "./app.ts";

/** Milliseconds between two changes of the address bar: browsers refuse more than about 200 in 30 s. */
const INTERVAL = 300;

export class Address {
  private time = 0;
  private shown = "";
  private isPush = false;
  private settled: Promise<void> = Promise.resolve();

  constructor(private readonly app: App) {}

  /** Follows a change, which is an entry of the history of its own if `isPush`. */
  follow(isPush: boolean) {
    this.isPush ||= isPush;
    const wait = this.isPush ? 0 : Math.max(0, this.time + INTERVAL - performance.now());
    const wasPush = this.isPush;
    const write = async () => {
      const hash = await this.hash();
      if (hash === this.shown) return;
      this.time = performance.now();
      this.put(hash, wasPush && this.isPush);
      this.isPush = false;
    };
    const inTurn = () => void (this.settled = this.settled.then(write));
    if (wait === 0) inTurn();
    else this.app.after("address", wait, inTurn);
  }

  /** Writes the address that is still due. */
  async settle() {
    await this.settled;
    this.app.cancel("address");
    this.put(await this.hash(), false);
  }

  /** Whether the address bar shows what the page wrote. */
  isOwn() {
    return location.hash === this.shown;
  }

  private async hash() {
    return `#${await this.app.fragment()}`;
  }

  private put(hash: string, isPush: boolean) {
    try {
      if (isPush) history.pushState(null, "", hash);
      else history.replaceState(null, "", hash);
    } catch {
      // A page inside a `srcdoc` frame has no address of its own.
    }
    this.shown = location.hash || hash;
  }
}
