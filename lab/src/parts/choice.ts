// What choosing a row, an entry or a node does, and whether it is chosen.

export interface Choice {
  /** Absent where only a step is shown. */
  isChosen?: boolean;
  choose: () => void;
}
