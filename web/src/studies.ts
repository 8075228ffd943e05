// Entry of the page of studies.
import "./style.css";
import "./studies.css";
import { StudyPage } from "./studies/page";
import { kLight, themeNow } from "./ui/theme";

const follow = (): void => void (document.documentElement.dataset.theme = themeNow());
follow();
kLight.addEventListener("change", follow);
void new StudyPage().start();
